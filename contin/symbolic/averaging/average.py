"""The averaging pass: weakly nonlinear oscillators -> the slow motion of their amplitudes and phases.

A derivation takes a second, most of it the computer algebra system's; what it gives is kept for the next process.
"""

from __future__ import annotations

from contin.model.kinds import need_model
from contin.model.model import Model
from contin.symbolic.averaging.derived import derived
from contin.symbolic.averaging.form_names import FORMS


def average(model: Model, form: str = "polar", time: str = "slow", order: int = 1, reach: float | None = None) -> Model:
    """The averaged system of a model of weakly nonlinear oscillators, as a model.

    x_i' = y_i, y_i' = -omega^2 x_i + eps F_i becomes the motion of the amplitudes and phases of
    x_i = r_i cos(omega t + theta_i), y_i = -omega r_i sin(omega t + theta_i), averaged over a turn (Krylov and
    Bogoliubov; Sanders, Verhulst and Murdock, Averaging Methods, ch. 2), accurate to order eps on times of order 1/eps.

    Parameters
    ----------
    form : 'polar' (r or r1 .. rN, psi or psi2 .. psiN), 'cartesian' (u1, v1, ...; A = u + i v) or 'stokes' (S1, S2, S3;
        two oscillators).
    time : 'slow' is eps t, in which eps drops out at first order; 'fast' keeps t.
    order : 1, or 2 for the corrections of order eps.
    reach : largest amplitude for which averages without a closed form are to be accurate; by default four times the
        largest of the starts, at least 4. The parameters' ranges count too. The model's `limits` say where they are
        not: branches and simulations end there.

    Named starts, symmetries (signed permutations of the oscillators) and observables that do not change along an
    oscillation are carried over; r1, r2, psi are observables of every form.

    Raises
    ------
    InputError
        The model is not of this kind; the message quotes the term that does not fit.
    """

    need_model(model)
    def derive() -> Model:
        from contin.symbolic.averaging.averaged import averaged  # not before: it brings computer algebra, half a second

        return averaged(model, form, time, order, reach).model

    if form not in FORMS:  # of a package, whose text is no part of the key
        return derive()
    return derived("average", model, (form, time, order, reach), derive)

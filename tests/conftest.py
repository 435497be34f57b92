"""Property tests: the same examples in every run; the first call of a kernel may compile for seconds.

numpy and BLAS compute as the command has them do, with the level of machine code and one thread, so that the same
digits are tested on every processor. `CONTIN_TARGET=x86-64-v2` tests those of another level, and
`CONTIN_TEST_LIBRARIES=processor` what numpy and BLAS choose by themselves, `CONTIN_TEST_NOISE=1` (any number) what
rounding may do anywhere (`tests/noise.py`), `CONTIN_TEST_UNWRITTEN=1` what memory held before may do
(`tests/unwritten.py`): the tests must pass with each.

`pytest -m fast` runs the core in under a minute once the kernels are compiled: what is in `FAST`, marked here.
`pytest -m 'seldom and not long'` runs what is dear beside cheaper tests of the same idea; `--share 2/6` the third sixth
of it.
`CONTIN_TEST_COST=20` tells what tests cost (`tests/cost.py`).
"""

import gc
import os
import sys
import warnings
import zlib
from pathlib import Path

if os.environ.get("CONTIN_TEST_LIBRARIES") == "processor":
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # read when numpy is imported, here and in processes that tests start
else:
    from contin.machine import environment

    environment.fix()

import pytest
from hypothesis import settings
from hypothesis.internal.conjecture import providers

if os.environ.get("CONTIN_TEST_NOISE"):
    from tests.noise import add_noise

    add_noise(int(os.environ["CONTIN_TEST_NOISE"]))

if os.environ.get("CONTIN_TEST_UNWRITTEN"):
    from tests.unwritten import fill_new_arrays

    fill_new_arrays()

settings.register_profile("contin", deadline=None, derandomize=True, max_examples=50)
settings.load_profile("contin")

if hasattr(providers, "_get_local_constants"):  # not of early versions
    # reading the constants of every module that was imported before takes seconds, and makes other examples of a test
    # that runs after others, or when a number is edited anywhere in contin
    providers._get_local_constants = lambda: providers._local_constants

gc.disable()  # collecting makes half a million objects and no garbage: a quarter of its time was spent looking for some

FAST = """
    continuation kernels lowering machine model normalforms simulate symbolic
    systems/functions loci/equilibria problems/maps/test_maps.py problems/equilibria/test_corners.py
    problems/orbits/test_defining.py problems/orbits/test_ends.py problems/orbits/test_meshes.py
    search/test_equilibrium_from_guess.py diagram/test_diagram.py diagram/phase/test_plane.py store/test_sqlite.py
    cli/test_bad_input.py special
""".split()
SLOW = """
    continuation/test_beside_births.py continuation/test_frames.py continuation/test_over_corners.py
    continuation/test_pairs_beside_ends.py continuation/test_planted_extrema.py kernels/test_lean.py
    kernels/test_library.py loci/equilibria/test_invariance.py loci/equilibria/test_kernels_of_two_dimensions.py
    loci/equilibria/test_near_crossings.py loci/equilibria/test_normal_forms.py loci/equilibria/test_poles_of_maps.py
    loci/equilibria/test_published.py loci/equilibria/test_three_within_a_step.py lowering/test_alike.py
    machine/test_no_libm.py machine/test_one_thread.py machine/test_threads.py model/test_fuzz.py model/test_kept.py
    model/test_printing.py normalforms/test_interacting_modes_of_maps.py normalforms/test_multiple.py
    normalforms/test_two_modes.py problems/equilibria/test_labels.py simulate/test_scan.py
    symbolic/test_averages_near_zero.py symbolic/test_averaging_one.py symbolic/test_averaging_several.py
    symbolic/test_derivation.py symbolic/test_derived.py symbolic/test_reach.py symbolic/test_remove_singularities.py
    symbolic/test_second_order.py symbolic/test_second_order_beside.py systems/functions/test_errors_of_differences.py
    systems/functions/test_few_states.py systems/functions/test_foreign_arrays.py systems/functions/test_grain.py
    systems/functions/test_processes.py systems/functions/test_trials.py
""".split()
# above a third of a second, in files whose other tests are quick
SLOW_TESTS = """
    continuation/test_decisions.py::test_rows_of_a_curve_of_folds_are_decided_by_the_rules
    continuation/test_extrema.py::test_a_parameter_that_is_constant_along_a_curve_turns_nowhere
    continuation/test_extrema.py::test_extrema_at_the_start
    continuation/test_needles_told.py::test_the_top_of_a_wide_needle_is_one_branch_point
    continuation/test_refined.py::test_problems_on_meshes_and_of_trajectories_are_refined
    continuation/test_rounding_in_products.py::test_period_doublings_are_found_and_what_rounding_hides_is_told
    continuation/test_user_values.py::test_user_values_in_every_step_leave_the_bifurcations_as_they_are
    kernels/test_vector.py::test_rows_times_factors_and_products_with_a_vector
    model/test_bundled.py::test_co_oxidation_has_its_folds_and_hopf_points_where_the_determinants_vanish
    model/test_messages.py::test_thousands_of_definitions_in_a_chain_are_no_problem
    model/test_parser.py::test_ten_thousand_terms_and_factors_are_read_in_linear_time
    model/test_graph_text.py::test_formulas_are_read_back_as_the_identical_nodes
    model/test_registry.py::test_listing_and_other_models_do_not_import_a_plugin
    model/test_registry.py::test_listing_has_names_titles_and_origin
    model/test_registry.py::test_a_plugin_may_give_a_folder_a_model_a_function_or_a_module
    model/test_registry.py::test_plugins_can_be_switched_off
    normalforms/test_entry.py::test_compiled_jet_places_the_active_parameters
    normalforms/test_maps.py::test_coefficient_of_the_delayed_logistic_map_is_the_measured_decay_of_its_orbits
    normalforms/test_resonant.py::test_a_third_multiplier_of_one_leaves_a_strong_resonance_without_coefficients
    problems/maps/test_maps.py::test_the_cascade_of_the_logistic_map_is_followed_to_period_64
    problems/maps/test_maps.py::test_the_explorer_follows_the_cascade_to_period_64_and_each_cycle_once
    problems/orbits/test_ends.py::test_a_family_that_shrinks_onto_a_doubly_degenerate_equilibrium_ends_there
    problems/orbits/test_ends.py::test_subharmonic_orbits_turn_round_at_their_branch_points_without_a_fold
    simulate/test_crossings.py::test_the_command_and_run_files_write_the_section
    simulate/test_extrema.py::test_extremes_of_a_relaxation_oscillation_are_those_of_its_spikes_and_not_of_the_samples
    simulate/test_flight.py::test_memory_does_not_grow_with_the_time
    simulate/test_run.py::test_stiff_relaxation_has_the_period_of_its_singular_limit
    store/test_sqlite.py::test_netcdf_groups_hold_the_columns
    symbolic/test_averaging_kicks.py::test_clocks_on_a_free_platform_move_as_their_average
    symbolic/test_derivatives.py::test_a_long_sum_costs_what_its_terms_cost
    symbolic/test_derivatives.py::test_directional_derivatives_of_random_compositions_agree_with_mpmath
    symbolic/test_passes.py::test_cartesian_averaged_pair_loses_in_phase_where_the_polar_one_does
    systems/functions/test_automatic.py::test_the_first_lyapunov_coefficient_is_exact
    systems/functions/test_functions.py::test_branch_points_and_switched_branches_agree_on_the_metronome_pair
    systems/functions/test_rotation.py::test_waves_that_pulsate_return_turned_and_start_from_samples_of_the_function_itself
""".split()
HERE = Path(__file__).parent
COST = os.environ.get("CONTIN_TEST_COST")


def pytest_collection_finish():
    """What was collected lives to the end, and is not looked through again."""
    _tell_of_defects()
    gc.freeze()
    gc.enable()
    gc.set_threshold(50_000, 20, 20)  # 700, 10, 10 look through models and kernels again and again: 4 % of the time


def pytest_runtest_setup(item):
    """The digits of mpmath that an earlier test asked for are not those of the next."""
    if "mpmath" in sys.modules:
        sys.modules["mpmath"].mp.prec = 53


_warned = []
PROVOKED = ("test_defects.py", "test_a_defect_")


def _tell_of_defects():
    """An error inside contin that was contained is a warning, and so a failure: a retry may have hidden it."""
    from contin.continuation import defects

    in_words = defects.described

    def described(error):
        test = os.environ.get("PYTEST_CURRENT_TEST", "")
        if not any(name in test for name in PROVOKED):
            warnings.warn(f"{test}: {in_words(error)}", RuntimeWarning, stacklevel=2)
        return in_words(error)

    defects.described = described


def pytest_warning_recorded(warning_message, nodeid):
    """Numbers that overflow, or divide rounding by rounding, are looked into: a coefficient was wrong behind one."""
    if issubclass(warning_message.category, RuntimeWarning):
        _warned.append(f"{nodeid}: {warning_message.message} ({warning_message.filename}:{warning_message.lineno})")


def pytest_addoption(parser):
    parser.addoption("--share", default="0/1", metavar="K/N", help="one of N shares of the tests chosen, K modulo N")


def pytest_configure(config):
    if COST:
        from tests import cost

        config.pluginmanager.register(cost)


def pytest_terminal_summary(terminalreporter):
    if COST:
        from tests.cost import summary

        for line in summary(int(COST)):
            terminalreporter.write_line(line)
    for line in _warned:
        terminalreporter.write_line(f"WARNED {line}", red=True)


@pytest.hookimpl(tryfirst=True)
def pytest_sessionfinish(session):
    if _warned and session.exitstatus == 0:
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


def is_fast(path: Path) -> bool:
    """Whether a file is, or is in, one of `FAST` and none of `SLOW`."""
    if not path.is_relative_to(HERE):
        return False
    relative = path.relative_to(HERE)
    inside = {relative.as_posix(), *(parent.as_posix() for parent in relative.parents)}
    return bool(inside & set(FAST)) and not inside & set(SLOW)


def pytest_ignore_collect(collection_path, config):
    """With `-m fast` other files are not even imported."""
    if config.option.markexpr == "fast" and collection_path.is_file() and not is_fast(collection_path):
        return True
    return None


def pytest_collection_modifyitems(config, items):
    """Marks what is `fast`, without long versions of its tests and dear ones; leaves one share of the tests."""
    part, parts = (int(number) for number in config.option.share.split("/"))
    others = [item for item in items if zlib.crc32(item.nodeid.encode()) % parts != part % parts]
    if others:
        config.hook.pytest_deselected(items=others)
        left_out = set(others)
        items[:] = [item for item in items if item not in left_out]
    for item in items:
        if is_fast(item.path) and not any(item.get_closest_marker(mark) for mark in ("long", "seldom")):
            name = f"{item.path.relative_to(HERE).as_posix()}::{getattr(item, 'originalname', None) or item.name}"
            if name not in SLOW_TESTS:
                item.add_marker("fast")

"""Bratu's problem on a square, spread over the processes of an MPI program, with PETSc.

    mpirun -n 2 python bratu.py             # LU factors of MUMPS
    mpirun -n 2 python bratu.py -n 60 -contin_pc_type gamg

-(u_xx + u_yy) = lam e^u on the unit square, u = 0 on its edges. The fold of the differential equation is at 6.808124.
"""

import sys

import petsc4py

petsc4py.init(sys.argv)
from petsc4py import PETSc  # noqa: E402 - PETSc reads the options first

import contin  # noqa: E402

n = PETSc.Options().getInt("n", 40)  # inner points a side
laplace = PETSc.Mat().createAIJ((n * n, n * n), nnz=5)
for k in range(*laplace.getOwnershipRange()):
    i, j = divmod(k, n)
    beside = [(i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)]
    columns = [k] + [a * n + b for a, b in beside if 0 <= a < n and 0 <= b < n]
    laplace.setValues([k], columns, [(n + 1) ** 2 * w for w in [-4.0] + [1.0] * (len(columns) - 1)])
laplace.assemble()


def heat(u, p):
    made = u.copy()
    made.exp()
    made.scale(p["lam"])
    return made


def residual(u, p, f):
    laplace.mult(u, f)
    f.axpy(1.0, heat(u, p))


def jacobian(u, p, J):
    laplace.copy(J)
    J.setDiagonal(laplace.getDiagonal() + heat(u, p))


def record(u, p):
    return {"top": u.max()[1]}


def follow(plate):
    return contin.continuation(contin.equilibrium(plate), "lam", (0, 8), settings={"steps": 24})


u0 = laplace.createVecLeft()  # zero
line = contin.from_petsc(residual, u0, {"lam": 0.0}, jacobian, laplace, record=record, name="bratu").run(follow)
if line is not None:  # on process 0
    print(f"{PETSc.COMM_WORLD.getSize()} processes, {n * n} unknowns, {len(line)} rows, {line.effort}")
    for point in line.points:
        print(f"{point.label} lam = {point.values['lam']:.10f} top = {point.values['top']:.8f}")

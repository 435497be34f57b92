! Two-component A -> B reaction (Uppal, Ray and Poore 1974), as in AUTO's demo ab.
subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  f(1) = -u(1) + par(1)*(1 - u(1))*exp(u(2))
  f(2) = -u(2) + par(1)*par(2)*(1 - u(1))*exp(u(2)) - par(3)*u(2)
end subroutine
subroutine stpnt(ndim, u, par, t)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  par(1) = 0; par(2) = 14; par(3) = 2
  u(1) = 0; u(2) = 0
end subroutine
subroutine bcnd
end subroutine
subroutine icnd
end subroutine
subroutine fopt
end subroutine
subroutine pvls
end subroutine

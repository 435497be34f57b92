! Two metronomes on a movable platform, averaged (Kato and Kori), from in-phase at mu = 10.
subroutine func(ndim,u,icp,par,ijac,f,dfdu,dfdp)
implicit none
integer, intent(in) :: ndim, icp(*), ijac
double precision, intent(in) :: u(ndim), par(*)
double precision, intent(out) :: f(ndim)
double precision, intent(inout) :: dfdu(ndim,ndim), dfdp(ndim,*)
double precision r1,r2,psi,mu,be,a,b,pi
r1=u(1);r2=u(2);psi=u(3);mu=par(1);be=par(2);a=par(3);b=par(4);pi=4*atan(1d0)
f(1)=(-6*pi*mu*r2*sin(psi)-6*pi*be*r1+3*a*r1**3-2*b*r1**5)/(12*pi)
f(2)=(6*pi*mu*r1*sin(psi)-6*pi*be*r2+3*a*r2**3-2*b*r2**5)/(12*pi)
f(3)=(16*mu*(r1/r2-r2/r1)*cos(psi)+6*a*(r1**2-r2**2)-5*b*(r1**4-r2**4))/32
end subroutine
subroutine stpnt(ndim,u,par,t)
implicit none
integer, intent(in) :: ndim
double precision, intent(inout) :: u(ndim), par(*)
double precision, intent(in) :: t
double precision pi
pi=4*atan(1d0)
par(1)=10;par(2)=0.8d0;par(3)=4;par(4)=1
u(1)=sqrt((12+sqrt(144-48*pi*0.8d0))/4);u(2)=u(1);u(3)=0
end subroutine
subroutine bcnd
end subroutine
subroutine icnd
end subroutine
subroutine fopt
end subroutine
subroutine pvls
end subroutine

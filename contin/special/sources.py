"""Where conditions and normal forms are from."""

from __future__ import annotations

from typing import Final

KUZNETSOV: Final = "Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed."
CYCLES: Final = "Kuznetsov, Govaerts, Doedel and Dhooge, SIAM J. Numer. Anal. 43 (2005) 1407"
CYCLES_TWO: Final = "De Witte, Della Rossa, Govaerts and Kuznetsov, SIAM J. Appl. Dyn. Syst. 12 (2013) 722"
MAPS: Final = "Kuznetsov and Meijer, SIAM J. Sci. Comput. 26 (2005) 1932"
FOLD_FLIP: Final = "Kuznetsov, Meijer and van Veen, Int. J. Bifurcation Chaos 14 (2004) 2253"
INTERACTING: Final = "Kuznetsov and Meijer, J. Difference Equ. Appl. 12 (2006) 1009"
SINGULARITIES: Final = "Golubitsky and Schaeffer, Singularities and Groups in Bifurcation Theory I"
HOMOCLINIC: Final = "Champneys, Kuznetsov and Sandstede, Int. J. Bifurcation Chaos 6 (1996) 867"
PIECEWISE: Final = "di Bernardo, Budd, Champneys and Kowalczyk, Piecewise-smooth Dynamical Systems"

"""Special orbits in two parameters: Newton on an orbit's equations with a bordered scalar, in one kernel call.

F(u, T, p, q) = 0 is the boundary-value problem of `contin.kernels.collocation`; q is a second parameter. With (s, r)
coordinates of the parameters' plane, (p, q) = s `across` + r `along`, and G(u, T, s, r) = 0 that a matrix is singular:

    LPC   [F_u F_T]                                        V, G from  [F_u F_T F_s; c] [V; G] = [0; 1]
    PD    variational equation, v(1) = -v(0)               v, G from  v(1) + v(0) = b G, c v(0) = 1
    NS    ... over two periods, v(2) - 2 k v(1) + v(0)     v, G (2)   v(2) - 2 k v(1) + v(0) = B G, C v(0) = e_1
    BPC   [F_u F_T F_s], u(1) - u(0) + b (unfolding)       V, G (2)   rows c for two null vectors

k = cos(angle) of a torus and the unfolding of branch points are unknowns too. Everything comes from one condensation of
the intervals: solutions y of F_(u, T, s) y = (-F, -F_r, 0) and V; dG y from the same factors with right-hand side
-D^2F[V, y], which needs D^2f[v, .] once at each Gauss point; Newton's step and the tangent are combinations of the y in
two or three dimensions. So no unknown is a null vector, and a step costs about twice one of the family.

Layout of z: u at the nodes, T, lengths of the intervals, [k or unfolding], q, p.
"""

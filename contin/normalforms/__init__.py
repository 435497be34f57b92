"""Coefficients at special points and what they mean: pure functions of the derivatives at one point (a `Jet`).

jet            Jet (what is needed of the equations), DerivativeJet (from a function of real directions)
sources        compiled_jet(system, u, p, active)
point          normal_form(type, jet) -> NormalForm by type code; what each type needs is in contin.special
fold           LP, CP
reduction      Lyapunov-Schmidt reduction to a few equations, any dimension of the kernel
branching      BP with a simple kernel;  multiple: larger kernels;  directions: all branches through either
hopf           HB, GH; predictors of the cycles and of their folds
bogdanov_takens, homoclinic, zero_hopf, hopf_hopf     BT, ZH, HH and the curves that start there
maps, map_resonances     PD, NS; GPD, CH, R1 to R4
fold_flip, fold_neimark_sacker, two_amplitudes      LPPD; LPNS; PDNS and NSNS;  modes_of_maps: what they share
propagated     errors of what is computed from coefficients
homological    Taylor coefficients of centre manifolds and normal forms to any order
words          type codes and coefficients in words
"""

"""Systems: values, Jacobians, derivatives, observables and switches of equations, wherever they come from."""

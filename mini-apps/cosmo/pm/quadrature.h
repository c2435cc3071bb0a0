// Integrals of smooth functions.
#pragma once

namespace cosmo {

// Simpson's rule on 2 * `pairs` intervals: the error falls with the fourth power of their width.
template <class Function>
double integral(double a, double b, int pairs, const Function& f) {
  const double h = (b - a) / (2.0 * pairs);
  double sum = f(a) + f(b);
  for (int i = 1; i < 2 * pairs; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * f(a + h * i);
  return sum * h / 3.0;
}

}  // namespace cosmo

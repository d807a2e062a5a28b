// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/base/distributions.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace todbench::distribution {
namespace {

boost::math::normal boost_law(const Normal& law) {
  return boost::math::normal(law.mean, law.sd);
}
boost::math::students_t boost_law(const StudentsT& law) {
  return boost::math::students_t(law.degrees_of_freedom);
}
boost::math::chi_squared boost_law(const ChiSquared& law) {
  return boost::math::chi_squared(law.degrees_of_freedom);
}
boost::math::fisher_f boost_law(const FisherF& law) {
  return boost::math::fisher_f(law.numerator_freedom, law.denominator_freedom);
}

bool few(const std::optional<double>& degrees_of_freedom) {
  return degrees_of_freedom && !std::isinf(*degrees_of_freedom);
}

}  // namespace

template <class Law>
double cdf(const Law& law, double x) {
  return boost::math::cdf(boost_law(law), x);
}

template <class Law>
double cdf(const Complement<Law>& above) {
  return boost::math::cdf(boost::math::complement(boost_law(above.law), above.value));
}

template <class Law>
double quantile(const Law& law, double probability) {
  return boost::math::quantile(boost_law(law), probability);
}

template <class Law>
double quantile(const Complement<Law>& above) {
  return boost::math::quantile(boost::math::complement(boost_law(above.law), above.value));
}

double pdf(const Normal& law, double x) {
  return boost::math::pdf(boost_law(law), x);
}

double tail_above(double x, const std::optional<double>& degrees_of_freedom) {
  return few(degrees_of_freedom) ? cdf(complement(StudentsT(*degrees_of_freedom), x)) : cdf(complement(Normal(), x));
}

double quantile_above(double probability, const std::optional<double>& degrees_of_freedom) {
  return few(degrees_of_freedom) ? quantile(complement(StudentsT(*degrees_of_freedom), probability))
                                 : quantile(complement(Normal(), probability));
}

template double cdf(const Normal&, double);
template double cdf(const Complement<Normal>&);
template double quantile(const Normal&, double);
template double quantile(const Complement<Normal>&);
template double cdf(const StudentsT&, double);
template double cdf(const Complement<StudentsT>&);
template double quantile(const StudentsT&, double);
template double quantile(const Complement<StudentsT>&);
template double cdf(const ChiSquared&, double);
template double cdf(const Complement<ChiSquared>&);
template double quantile(const ChiSquared&, double);
template double quantile(const Complement<ChiSquared>&);
template double cdf(const FisherF&, double);
template double cdf(const Complement<FisherF>&);
template double quantile(const FisherF&, double);
template double quantile(const Complement<FisherF>&);

}  // namespace todbench::distribution

// Standard uncertainties joined into one, and what it is worth where some of them rest on few observations.
#pragma once

#include <optional>

namespace todbench {

/// Independent contributions: the root of the sum of their squares, with the degrees of freedom of Welch and
/// Satterthwaite (JCGM 100:2008, G.4).
class JoinedUncertainty {
 public:
  /// A standard uncertainty in the unit of the result; no degrees of freedom: very many.
  void add(double standard, const std::optional<double>& degrees_of_freedom);
  [[nodiscard]] double u() const { return u_; }
  /// Student's t for this upper tail times u.
  [[nodiscard]] double half_width(double upper_tail) const;

 private:
  double u_ = 0;
  double of_few_ = 0;  ///< root of the sum of u^4 / nu
};

}  // namespace todbench

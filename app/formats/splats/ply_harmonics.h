#pragma once

#include "app/formats/ply/ply_table.h"
#include "app/formats/splats/splats.h"

#include <algorithm>
#include <string>

namespace gs::app {

/// Returns the degree of the spherical harmonics in the properties `f_rest_0`, `f_rest_1`, ... of an element. Each of
/// three colours has (degree + 1)^2 - 1 of them. Returns 0 if there are none.
[[nodiscard]] inline int harmonics_degree(const PlyElement& element) {
  constexpr int kMaxDegree = 4;
  const auto has = [&](int number) {
    const std::string name = "f_rest_" + std::to_string(number);
    return std::any_of(element.properties.begin(), element.properties.end(),
                       [&](const PlyProperty& p) { return !p.is_list && p.name == name; });
  };
  int degree = 0;
  while (degree < kMaxDegree && has(3 * degree * (degree + 2))) ++degree;
  return degree;
}

/// Calls read(channel, number, column) for each coefficient of a model: `column` is N of its property `f_rest_N`. All
/// columns of red come first, then those of green and blue.
template <class Read>
void for_coefficients(const SplatModel& model, const Read& read) {
  const std::size_t used = qnv::harmonic_count(model.degree), in_file = qnv::harmonic_count(model.harmonics);
  for (std::size_t channel = 0; channel < 3; ++channel)
    for (std::size_t number = 0; number < used; ++number) read(channel, number, channel * in_file + number);
}

}  // namespace gs::app

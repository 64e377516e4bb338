#pragma once

#include "app/formats/common/ply_table.h"

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

}  // namespace gs::app

#pragma once

#include "qnv/encode_surface.h"

#include <catch2/catch.hpp>

#include <glm/vec3.hpp>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// A packed stream of a bumpy ball, of more than a megabyte: long enough to be read here and there.
inline const std::string& large_stream() {
  static const std::string bytes = [] {
    constexpr int kSteps = 400;
    const auto at = [](int i, int j) {
      const double a = std::numbers::pi * i / kSteps, b = std::numbers::pi * j / kSteps;
      return glm::vec3(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)) *
             static_cast<float>(1 + 0.05 * std::sin(9 * a) * std::sin(8 * b));
    };
    std::vector<qnv::Triangle> triangles;
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < 2 * kSteps; ++j) {
        triangles.emplace_back().positions = {at(i, j), at(i + 1, j), at(i + 1, j + 1)};
        triangles.emplace_back().positions = {at(i, j), at(i + 1, j + 1), at(i, j + 1)};
      }
    qnv::EncodeOptions options;
    options.vectors = 1'500'000;
    auto encoded = qnv::encode_surface([&](const qnv::TriangleSink& sink) { return sink(triangles); }, options);
    REQUIRE(std::holds_alternative<qnv::EncodedStream>(encoded));
    const auto& all = std::get<qnv::EncodedStream>(encoded).bytes;
    return std::string(reinterpret_cast<const char*>(all.data()), all.size());
  }();
  REQUIRE(bytes.size() > (std::size_t{1} << 20));
  return bytes;
}

}  // namespace gs::app

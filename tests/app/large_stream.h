#pragma once

#include "net/files/file.h"
#include "qnv/codecs/octree/encode/encode_surface.h"
#include "qnv/codecs/shared/encode_options.h"

#include <catch2/catch.hpp>

#include <glm/vec3.hpp>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <span>
#include <string>
#include <system_error>
#include <variant>
#include <vector>

namespace gs::app {

/// Returns the encoded stream.
inline std::string encoded_large_stream() {
  constexpr int kSteps = 400;
  const auto at = [](int i, int j) {
    const double a = std::numbers::pi * i / kSteps, b = std::numbers::pi * j / kSteps;
    return glm::vec3(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)) *
           static_cast<float>(1 + 0.05 * std::sin(9 * a) * std::sin(8 * b) +
                              0.004 * std::sin(81 * a) * std::sin(80 * b));
  };
  std::vector<qnv::Triangle> triangles;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < 2 * kSteps; ++j) {
      triangles.emplace_back().positions = {at(i, j), at(i + 1, j), at(i + 1, j + 1)};
      triangles.emplace_back().positions = {at(i, j), at(i + 1, j + 1), at(i, j + 1)};
    }
  qnv::EncodeOptions options;
  options.vectors = 1'000'000;
  auto encoded = qnv::encode_surface([&](const qnv::TriangleSink& sink) { return sink(triangles); }, options);
  REQUIRE(std::holds_alternative<qnv::EncodedStream>(encoded));
  const auto& all = std::get<qnv::EncodedStream>(encoded).bytes;
  return std::string(reinterpret_cast<const char*>(all.data()), all.size());
}

/// Returns an octree stream of a bumpy ball of over a megabyte, long enough for partial reads. Tests are separate
/// processes, so the first test that needs the stream stores it beside the program. The file is valid until the program
/// changes.
inline const std::string& large_stream() {
  static const std::string bytes = [] {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::path kept = fs::path(GHOSTSPACE_BINARY).parent_path() / "large_stream.qnv";
    const auto made = fs::last_write_time(kept, error);
    if (!error && made > fs::last_write_time(GHOSTSPACE_BINARY)) {
      std::ifstream in(kept, std::ios::binary);
      std::string all{std::istreambuf_iterator<char>(in), {}};
      if (all.size() > (std::size_t{1} << 20)) return all;
    }
    const std::string all = encoded_large_stream();
    (void)net::write_file_atomically(kept.string(), std::as_bytes(std::span(all)));
    return all;
  }();
  REQUIRE(bytes.size() > (std::size_t{1} << 20));
  return bytes;
}

}  // namespace gs::app

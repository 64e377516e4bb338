#pragma once

// Helpers of tests of encode, info and export: runs of the program, and its inputs.
#include "app/base/exit_status.h"
#include "app/formats/volume/volume.h"
#include "tests/app/run_program.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>
#include <utility>
#include <variant>

namespace gs::test {

using app::kDone;
using app::quoted;
using app::Run;
using app::run;

inline nlohmann::json info(const std::string& file, const std::string& options = {}) {
  const Run result = run("info --json " + options + " " + quoted(file));
  INFO(result.output);
  REQUIRE(result.status == kDone);
  return nlohmann::json::parse(result.output);
}

/// Opens a volume file, which must be readable.
inline qnv::VolumeSource opened_volume(const std::string& path) {
  auto opened = app::open_volume(path);
  const auto* const problem = std::get_if<std::string>(&opened);
  INFO((problem ? *problem : path));
  REQUIRE_FALSE(problem);
  return std::get<qnv::VolumeSource>(std::move(opened));
}

inline const std::string kBall =
    "#VRML V2.0 utf8\nWorldInfo { title \"The ball\" }\n"
    "Shape { appearance Appearance { material Material { diffuseColor 1 0 0 } } geometry Sphere { radius 2 } }\n";
inline constexpr double kBallArea = 50.2655;

// Returns a ball of 16 in a cube of 32, with values that fall from its centre to its surface.
inline std::string raw_ball() {
  std::string voxels;
  for (int z = -16; z < 16; ++z)
    for (int y = -16; y < 16; ++y)
      for (int x = -16; x < 16; ++x)
        voxels += static_cast<char>(std::max(0, 200 - 200 * (x * x + y * y + z * z) / 196));
  return voxels;
}

}  // namespace gs::test

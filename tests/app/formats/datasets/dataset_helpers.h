#pragma once

#include "app/formats/datasets/dataset_formats.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "tests/app/formats_helpers.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

/// Helpers of tests of files with datasets.
namespace gs::test {

/// File of datasets in memory, with the choice of a user.
class DatasetSample {
 public:
  explicit DatasetSample(Bytes bytes, std::string path = "sample", app::VoxelComponent choice = {})
      : bytes_(std::move(bytes)), path_(std::move(path)), choice_(std::move(choice)) {}

  [[nodiscard]] app::ImportSource source() {
    app::ImportSource made{bytes_, path_, read_file, budget_, diagnostics};
    made.component = choice_;
    return made;
  }
  [[nodiscard]] app::VolumeResult volume() const {
    return app::open_datasets(
        {path_, path_.substr(path_.rfind('/') + 1), app::shared_bytes(bytes_), read_file, budget_, choice_});
  }
  /// Opens a volume that must exist.
  [[nodiscard]] qnv::VolumeSource opened() const {
    app::VolumeResult result = volume();
    if (const auto* const problem = std::get_if<std::string>(&result)) FAIL(path_ << ": " << *problem);
    return std::get<qnv::VolumeSource>(result);
  }
  [[nodiscard]] std::string problem() const {
    const app::VolumeResult result = volume();
    return std::holds_alternative<std::string>(result) ? std::get<std::string>(result) : std::string();
  }
  [[nodiscard]] std::vector<app::DatasetEntry> entries() {
    auto listed = app::list_datasets(source());
    if (const auto* const problem = std::get_if<std::string>(&listed)) FAIL(path_ << ": " << *problem);
    return std::get<std::vector<app::DatasetEntry>>(listed);
  }
  /// Reads a mesh. There must be one.
  [[nodiscard]] app::MeshAsset mesh() {
    REQUIRE(app::holds_dataset_mesh(source()));
    app::Asset asset = app::read_dataset_mesh(source());
    REQUIRE(std::holds_alternative<app::MeshAsset>(asset));
    return std::get<app::MeshAsset>(std::move(asset));
  }

  app::ReadFile read_file;
  Diagnostics diagnostics;

 private:
  Bytes bytes_;
  std::string path_;
  app::VoxelComponent choice_;
  WorldBudget budget_ = own_budget();
};

[[nodiscard]] inline app::VoxelComponent dataset_choice(std::string path) {
  app::VoxelComponent choice;
  choice.dataset = std::move(path);
  return choice;
}

/// Numbers of all values of a volume and its steps.
struct ValueFacts {
  double least = INFINITY, most = -INFINITY, mean = 0;
  std::uint64_t missing = 0;
};
[[nodiscard]] inline ValueFacts facts_of(const qnv::VolumeSource& source) {
  ValueFacts facts;
  std::vector<std::byte> scratch;
  std::vector<float> slice(qnv::slice_voxels(source.layout));
  std::uint64_t count = 0;
  std::vector<const qnv::VolumeSource*> steps;
  for (const qnv::VolumeSource& step : source.steps) steps.push_back(&step);
  if (steps.empty()) steps.push_back(&source);
  for (const qnv::VolumeSource* const step : steps)
    for (std::uint32_t z = 0; z < step->layout.dimensions[2]; ++z) {
      REQUIRE(qnv::read_slice(*step, z, scratch, slice));
      for (const float value : slice) {
        if (std::isnan(value)) {
          ++facts.missing;
          continue;
        }
        facts.least = std::min(facts.least, static_cast<double>(value));
        facts.most = std::max(facts.most, static_cast<double>(value));
        facts.mean += static_cast<double>(value);
        ++count;
      }
    }
  facts.mean /= static_cast<double>(std::max<std::uint64_t>(count, 1));
  return facts;
}

/// Runs a Python script with h5py, numpy (np) and netCDF4 in a folder. Returns false, with a warning, if one of them is
/// missing.
[[nodiscard]] inline bool run_python(const ScratchFolder& folder, const std::string& script) {
  for (const char* const python : {"/usr/bin/python3", "python3"}) {
    if (std::system((std::string(python) + " -c 'import h5py, netCDF4' >/dev/null 2>&1").c_str()) != 0) continue;
    const std::string path = folder.write("make.py", "import h5py, netCDF4\nimport numpy as np\n" + script);
    REQUIRE(std::system(("cd '" + folder.path("") + "' && " + python + " make.py").c_str()) == 0);
    return true;
  }
  WARN("python3-h5py and python3-netcdf4 are not here");
  return false;
}

}  // namespace gs::test

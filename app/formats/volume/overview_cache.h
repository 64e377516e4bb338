#pragma once

#include "app/formats/common/voxel_component.h"
#include "qnv/sampling/volume/volume.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Folder with overviews of large arrays in local files, so that an array is immediately visible when it is opened
/// again. Damaged files in it count as absent. The oldest files are removed.
class OverviewCache {
 public:
  /// An empty folder means that nothing is kept.
  explicit OverviewCache(std::string folder, std::uint64_t most_bytes = std::uint64_t{512} << 20)
      : folder_(std::move(folder)), most_bytes_(most_bytes) {}

  /// Returns the samples that keep() stored under this key; nullopt if there are none.
  [[nodiscard]] std::optional<std::vector<float>> find(const std::string& key) const;
  /// Writes samples. Does nothing if that fails, or if they take more than a quarter of the folder's limit.
  void keep(const std::string& key, std::span<const float> samples) const;

 private:
  [[nodiscard]] std::string path_of(const std::string& key) const;
  void remove_oldest(std::uint64_t coming) const;

  std::string folder_;
  std::uint64_t most_bytes_;
};

/// Returns the folder of overviews beside the folder of the HTTP cache; empty if that is empty.
[[nodiscard]] std::string overview_folder(const std::string& http_cache);

/// Returns the key of the overview of a part of a local file: its path, size and time of modification, the part, and the
/// form of the volume. Returns nullopt if the volume is not in one file.
[[nodiscard]] std::optional<std::string> overview_key(const std::string& path, const VoxelComponent& component,
                                                      const qnv::VolumeLayout& layout);

}  // namespace gs::app

#pragma once

#include "app/formats/common/dataset_list.h"
#include "app/formats/common/import_limits.h"
#include "app/formats/common/voxel_component.h"
#include "app/formats/volume/raw_volume.h"
#include "qnv/sampling/volume/volume.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

// Bytes of requests and replies between this process and a child that keeps a volume open.
namespace gs::app {

/// Request to open a volume, or to list the datasets of a file, without the bytes of the file.
struct VolumeRequest {
  std::string path, name;  // location of the file; its name at the original source
  RawVolume raw{};
  VoxelComponent component{};
  BudgetLeft left{};
  bool lists = false;
  bool by_parts = false;  // the child requests the parts of the file that it reads
};
[[nodiscard]] std::vector<std::byte> transfer_bytes(const VolumeRequest& request);
[[nodiscard]] std::optional<VolumeRequest> volume_request_of(std::span<const std::byte> bytes);

/// Volume in a child, or the error message.
struct VolumeReply {
  std::variant<qnv::VolumeSource, std::string> volume;
  std::uint64_t held = 0;  // bytes of voxels that the child holds in memory
  DatasetList datasets{};  // of the file, also if it holds no volume
};
[[nodiscard]] std::vector<std::byte> transfer_bytes(const VolumeReply& reply);

/// Sources of a volume in the order of their numbers: the source itself, its components, its steps, and the components
/// of each step behind the step; then the coarser versions in the same way.
[[nodiscard]] std::vector<const qnv::VolumeSource*> numbered_sources(const qnv::VolumeSource& volume);

/// Box of voxels as the numbers of a request: first voxel, size and steps.
[[nodiscard]] std::array<std::uint32_t, 9> numbers_of(const qnv::VoxelBox& box);
[[nodiscard]] qnv::VoxelBox voxel_box_of(const std::array<std::uint32_t, 9>& numbers);

/// Makes the function that reads a source of a volume in a child.
using MakeSliceReader =
    std::function<decltype(qnv::VolumeSource::read)(std::size_t number, const qnv::VolumeLayout& layout)>;
/// Makes the function that reads boxes of a source of a volume in a child.
using MakeBoxReader = std::function<decltype(qnv::VolumeSource::read_box)(std::size_t number)>;
/// Reads the reply of a child. Trusts nothing: layouts must pass qnv::check(), all sources have the same dimensions,
/// times ascend, and colours have three or four components of 8 bits. Otherwise returns nullopt.
[[nodiscard]] std::optional<VolumeReply> volume_reply_of(std::span<const std::byte> bytes, const MakeSliceReader& make,
                                                         const MakeBoxReader& make_box = {});

}  // namespace gs::app

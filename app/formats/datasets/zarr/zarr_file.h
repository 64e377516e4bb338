#pragma once

#include "app/base/read_files.h"
#include "app/formats/datasets/arrays/array_file.h"
#include "app/formats/datasets/zarr/zarr_array.h"
#include "app/formats/datasets/zarr/zarr_image.h"
#include "base/budget.h"

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app {

/// Names of files that describe a group or an array. A container is opened through one of them.
inline constexpr std::string_view kZarrMetadataFiles[] = {"zarr.json", ".zmetadata", ".zattrs",
                                                          ".zgroup",   ".zarray",    "attributes.json"};

/// Place of a container: how its files are read. References are relative to its folder.
struct ZarrPlace {
  ReadFiles read;
  ListFolder list = {};  // null if folders cannot be listed
  WorldBudget budget = own_budget();
  bool remote = false;  // on a server
};

/// Zarr or N5 container: a folder, a group or a single array.
class ZarrFile : public ArrayFile {
 public:
  /// Opens the container of a place. Returns a message on failure. Safe for untrusted files.
  [[nodiscard]] static std::variant<std::shared_ptr<ZarrFile>, std::string> open(ZarrPlace place);
  ~ZarrFile() override;

  [[nodiscard]] const std::vector<ArrayInfo>& arrays() const override { return infos_; }
  [[nodiscard]] const std::vector<std::string>& groups() const override { return groups_; }
  [[nodiscard]] std::vector<ArrayAttribute> attributes(const std::string& path) override;
  [[nodiscard]] std::string read(std::size_t array, std::span<const std::uint64_t> first,
                                 std::span<const std::uint64_t> count, std::span<std::byte> to) override;

  /// Returns the images of OME-Zarr; the first one is the main one, others are its labels or further images.
  [[nodiscard]] const std::vector<ZarrImage>& images() const { return images_; }
  /// Returns true if the container is on a server.
  [[nodiscard]] bool is_remote() const { return place_.remote; }
  /// Returns a message about chunks that could not be read so far; empty if there are none.
  [[nodiscard]] std::string trouble() const override;

 private:
  class Finder;
  struct Array;
  explicit ZarrFile(ZarrPlace place);

  ZarrPlace place_;
  std::vector<ArrayInfo> infos_;
  std::vector<Array> arrays_;  // as infos_
  std::vector<std::string> groups_;
  std::map<std::string, std::vector<ArrayAttribute>> attributes_;  // by path
  std::vector<ZarrImage> images_;
};

}  // namespace gs::app

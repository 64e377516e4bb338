#pragma once

#include "app/formats/datasets/vtk/vtk_index.h"

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app {

/// File of VTK that was opened.
struct VtkOpened {
  std::string path;  // relative to the folder of the first file; empty for that file itself
  SharedBytes bytes;
  VtkFileClass kind = VtkFileClass::other;
  VtkXmlHeader header;  // of a leaf
  VtkIndex index;       // of a file that names others
};
using VtkOpenedResult = std::variant<std::shared_ptr<const VtkOpened>, std::string>;

/// Files referenced by a VTK file. Reads them on demand and keeps the last ones opened. One thread at a time.
class VtkFiles {
 public:
  explicit VtkFiles(VolumeFile file) : file_(std::move(file)) {}

  /// Opens a file by its path relative to the folder of the first file; the first file has an empty path. Returns a
  /// message on failure.
  [[nodiscard]] VtkOpenedResult open(const std::string& path);
  /// Returns the path of a member of a file.
  [[nodiscard]] static std::string path_of(const VtkOpened& file, const VtkMember& member);

  /// Notes a file that is left out.
  void note_missing(const std::string& path, const std::string& problem);
  /// Returns a message about such files, the first one by name; empty if there are none.
  [[nodiscard]] std::string missing() const;

  /// Switches to the read functions that also work while slices are read.
  void read_lazily() { lazy_ = true; }
  [[nodiscard]] const VolumeFile& first() const { return file_; }

 private:
  [[nodiscard]] BytesResult load(const std::string& path) const;

  static constexpr std::size_t kMostKept = 64;

  VolumeFile file_;
  bool lazy_ = false;
  std::map<std::string, std::shared_ptr<const VtkOpened>> kept_;
  std::vector<std::string> order_;  // paths of `kept_`, the oldest first
  std::map<std::string, std::string> missing_;
  std::string first_missing_;
};

}  // namespace gs::app

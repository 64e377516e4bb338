#pragma once

#include "render/image/image.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace gs::app {

/// Small pictures of recent files, for the start page. Each is a PNG file in a folder that only the user can read. One
/// thread.
class Thumbnails {
 public:
  static constexpr int kWidth = 240, kHeight = 150;  // pixels

  /// If `folder` is empty, nothing is read or written.
  explicit Thumbnails(std::string folder) : folder_(std::move(folder)) {}

  /// Returns the thumbnail of a path or URL; null if there is none or its file is damaged.
  [[nodiscard]] std::shared_ptr<const render::Image> find(const std::string& place);
  /// Stores the thumbnail of a path or URL as PNG bytes. Does nothing if the file cannot be written.
  void keep(const std::string& place, const std::vector<std::byte>& png);
  /// Removes the thumbnails of all other paths and URLs.
  void keep_only(const std::vector<std::string>& places);

 private:
  [[nodiscard]] std::string file_of(const std::string& place) const;

  std::string folder_;
  std::map<std::string, std::shared_ptr<const render::Image>> images_;  // by path or URL; null if there is no file
};

}  // namespace gs::app

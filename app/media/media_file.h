#pragma once

#include "app/confined/media_decoding.h"
#include "base/budget.h"
#include "base/noncopyable.h"
#include "net/files/file.h"
#include "render/media/sample_reader.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// Encoded sound or movie file that is decoded during playback. Immutable. Any thread.
class MediaFile : NonCopyable {
 public:
  /// Holds the bytes of a file from the network, with their share of the memory budget.
  MediaFile(std::vector<std::byte> bytes, Share held) : copy_(std::move(bytes)), held_(std::move(held)) {}
  explicit MediaFile(net::MappedFile file, Share held) : held_(std::move(held)), file_(std::move(file)) {}

  [[nodiscard]] std::span<const std::byte> bytes() const { return file_ ? file_->bytes() : copy_; }
  [[nodiscard]] EncodedMedia encoded() const { return {bytes(), file_ ? file_->descriptor() : -1}; }

  render::MediaInfo info;
  std::string name;  // name of the file in messages

 private:
  std::vector<std::byte> copy_;
  Share held_;
  std::optional<net::MappedFile> file_;
};

}  // namespace gs::app

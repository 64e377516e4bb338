#pragma once

#include "app/base/read_file.h"
#include "base/noncopyable.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Data that a child keeps open for its parent, such as a volume. One thread.
class OpenData : NonCopyable {
 public:
  virtual ~OpenData() = default;
  /// Opens a file, or lists its contents, as `request` states. Returns the bytes of the reply.
  [[nodiscard]] virtual std::vector<std::byte> open(std::span<const std::byte> request, SharedBytes file,
                                                    const ReadFile& ask) = 0;
  /// Reads a slice of a source in the reply. Returns false on failure, or if there is no such slice.
  [[nodiscard]] virtual bool read_slice(std::uint64_t source, std::uint64_t slice, std::span<std::byte> to) = 0;
  /// Reads voxels of a box of a source: `box` has the first voxel, the numbers of voxels and the steps along x, y and z.
  /// Returns false on failure, or if there is no such box.
  [[nodiscard]] virtual bool read_box(std::uint64_t, const std::array<std::uint32_t, 9>&, std::span<std::byte>) {
    return false;
  }
  /// Returns a message about parts that could not be read so far; empty if there are none.
  [[nodiscard]] virtual std::string trouble() const { return {}; }
};
/// Makes the data of a child, before a file is open.
using MakeOpenData = std::unique_ptr<OpenData> (*)();

/// Answers requests for data until the parent closes its socket. This process is confined already.
void serve_data(OpenData& data);

}  // namespace gs::app

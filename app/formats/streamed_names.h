#pragma once

#include <string>
#include <string_view>

namespace gs::app {

/// Returns true if a file of this name can be encoded as a QNV stream.
[[nodiscard]] bool can_be_encoded(std::string_view name);

/// Extension that the stream of a file adds to the name of the file.
inline constexpr std::string_view kStreamExtension = ".qnv";
/// Extension that the coarse stream of a volume, with every n-th voxel, adds to the name of the file. A server that is
/// reached by ssh makes this stream quickly, and offers it until the complete stream is ready.
inline constexpr std::string_view kCoarseExtension = ".coarse.qnv";

/// Returns the name under which a server streams a file to viewers: that of the made stream, if the file has a format
/// other than VRML that can be encoded. Otherwise, returns the name.
[[nodiscard]] std::string streamed_name(const std::string& name);

}  // namespace gs::app

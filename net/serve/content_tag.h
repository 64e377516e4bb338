#pragma once

#include "net/base/descriptor.h"

#include <optional>
#include <stop_token>
#include <string>

// Entity tags of made files. A tag depends on the bytes alone. Servers that make equal bytes send equal tags, and other
// bytes, such as those of another version of the encoder, get another tag.
namespace gs::net {

/// Computes the tag of a complete file, and stores it in an extended attribute of the file. Stores nothing if the file
/// system has no such attributes, or after a stop request. Reads the whole file.
void store_content_tag(const std::string& path, const std::stop_token& stop);
/// Returns the stored tag with its quotes. Returns nullopt if the file has none.
[[nodiscard]] std::optional<std::string> content_tag_of(const Descriptor& file);

}  // namespace gs::net

#pragma once

#include "app/base/need_bytes.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::net {
class MappedFile;
}

namespace gs::app {

/// Bytes with shared ownership: a mapped file, or memory.
struct SharedBytes {
  std::shared_ptr<const void> owner;
  std::span<const std::byte> bytes;
  const net::MappedFile* file = nullptr;  // mapped file that owns the bytes, or null; other processes may change it
  NeedBytes need{};                       // receives missing bytes from a server; null if all bytes are present
};
[[nodiscard]] inline SharedBytes shared_bytes(std::vector<std::byte> bytes) {
  auto owner = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
  return {owner, std::span<const std::byte>(*owner)};
}

/// Bytes, or the error message.
using BytesResult = std::variant<SharedBytes, std::string>;

/// Function that reads a file to which another file refers. `reference` is a URL reference as written in that other
/// file; for a path, use net::reference_of_path(). The function resolves the reference and applies the reference policy
/// (net/base/reference_policy.h).
using ReadFile = std::function<BytesResult(const std::string& reference)>;

/// Reference that a ReadFile for the files of a folder answers with their names: paths relative to the folder, one a
/// line.
inline constexpr const char* kFolderReference = "./";

}  // namespace gs::app

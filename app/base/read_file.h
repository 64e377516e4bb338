#pragma once

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

/// Bytes with their shared owner: a mapped file or memory.
struct SharedBytes {
  std::shared_ptr<const void> owner;
  std::span<const std::byte> bytes;
  const net::MappedFile* file = nullptr;  // the owner if it is a mapped file, which other processes may change
};
[[nodiscard]] inline SharedBytes shared_bytes(std::vector<std::byte> bytes) {
  auto owner = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
  return {owner, std::span<const std::byte>(*owner)};
}

/// Bytes, or the reason why they are missing.
using BytesResult = std::variant<SharedBytes, std::string>;

/// Function that reads a file that another file refers to. The name is a URL reference as written in that file; for a
/// path, see net::reference_of_path(). The callee resolves it and applies the reference policy
/// (net/base/reference_policy.h).
using ReadFile = std::function<BytesResult(const std::string& reference)>;

}  // namespace gs::app

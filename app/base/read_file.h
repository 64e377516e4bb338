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

/// Bytes with an owner that they share: of a mapped file, or in memory.
struct SharedBytes {
  std::shared_ptr<const void> owner;
  std::span<const std::byte> bytes;
  const net::MappedFile* file = nullptr;  // the owner, where it is one: others may change it
};
[[nodiscard]] inline SharedBytes shared_bytes(std::vector<std::byte> bytes) {
  auto owner = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
  return {owner, std::span<const std::byte>(*owner)};
}

/// Bytes, or why there are none.
using BytesResult = std::variant<SharedBytes, std::string>;

/// The bytes of a file that another one names. The name is a URL reference as written in that file (of a path:
/// net::reference_of_path); the callee resolves it, and decides by the one rule what may be read
/// (net/base/reference_policy.h).
using ReadFile = std::function<BytesResult(const std::string& reference)>;

}  // namespace gs::app

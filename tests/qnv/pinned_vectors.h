#pragma once

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace gs::qnv {

/// Reads a file of the pinned test vectors.
inline std::vector<std::byte> read_bytes(const std::string& name, const std::string& version = "v1") {
  std::ifstream in(GHOSTSPACE_TESTS "/qnv/vectors/" + version + "/" + name, std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(in), {}};
  std::vector<std::byte> bytes(text.size());
  std::transform(text.begin(), text.end(), bytes.begin(), [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}

}  // namespace gs::qnv

#pragma once

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace gs::qnv {

/// Reads a file of the pinned test vectors as text.
inline std::string read_text(const std::string& name, const std::string& version = "v1") {
  std::ifstream in(GHOSTSPACE_TESTS "/qnv/vectors/" + version + "/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
inline std::vector<std::byte> read_bytes(const std::string& name, const std::string& version = "v1") {
  const std::string text = read_text(name, version);
  std::vector<std::byte> bytes(text.size());
  std::transform(text.begin(), text.end(), bytes.begin(), [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}

}  // namespace gs::qnv

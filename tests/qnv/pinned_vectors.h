#pragma once

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
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

/// Checks what an independent decoder in Python prints for a pinned stream. Warns if there is no Python.
inline void check_independent_decoder(const std::string& script, const std::string& name, const std::string& expected) {
  if (std::system("python3 -c pass >/dev/null 2>&1") != 0) {
    WARN("python3 is not here");
    return;
  }
  const std::string folder = GHOSTSPACE_TESTS "/qnv/vectors/";
  std::FILE* pipe = popen(("python3 '" + folder + script + "' '" + folder + "v1/" + name + ".qnv'").c_str(), "r");
  REQUIRE(pipe);
  std::string output;
  char buffer[4096];
  for (std::size_t size = 0; (size = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) output.append(buffer, size);
  CHECK(pclose(pipe) == 0);
  CHECK(output == expected);
}

}  // namespace gs::qnv

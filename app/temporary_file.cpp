#include "app/temporary_file.h"

#include "net/file.h"

#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace gs::app {
namespace {

namespace fs = std::filesystem;

std::string file_name_part(const std::string& name) {
  std::string result;
  for (const char c : name.substr(0, 100))
    result += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ? c : '_';
  return result;
}

}  // namespace

TemporaryFile::TemporaryFile(const std::string& name, std::span<const std::byte> bytes) {
  std::error_code error;
  const fs::path base = fs::temp_directory_path(error);
  std::string folder = (base / "ghostspace-XXXXXX").string();
  if (error || !mkdtemp(folder.data())) {
    problem_ = "no folder for temporary files can be made";
    return;
  }
  folder_ = folder;
  path_ = (fs::path(folder) / ("x" + file_name_part(name))).string();
  if (const auto failed = net::write_file_atomically(path_, bytes)) problem_ = failed->message;
}

TemporaryFile::~TemporaryFile() {
  std::error_code error;
  if (!folder_.empty()) fs::remove_all(folder_, error);
}

}  // namespace gs::app

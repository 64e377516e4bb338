#include "app/loading/world_loader.h"
#include "app/session/documents/documents.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

namespace gs::app::sparse_files_test {
namespace {

struct Read {
  std::string said;
  double seconds = 0;
};
/// Loads a sparse file of four gigabytes: `head`, then zeros.
Read read_sparse(const std::string& name, const std::string& head) {
  const ScratchFolder folder;
  const std::string path = folder.write(name, head);
  std::filesystem::resize_file(path, std::uint64_t{4} << 30);
  const auto begin = std::chrono::steady_clock::now();
  Read read;
  const LoadedWorld world = load_world(path, {});
  read.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (const auto& diagnostic : world.diagnostics.entries()) read.said += diagnostic.message + "\n";
  CHECK_FALSE(world.scene);
  return read;
}

}  // namespace

TEST_CASE("refuses large sparse files by their first bytes") {
  for (const char* name : {"zeros.ply", "zeros.vtk", "ZEROS.PLY"}) {
    INFO(name);
    const Read read = read_sparse(name, "");
    INFO(read.said);
    CHECK(read.said.find("as its first bytes") != std::string::npos);
    CHECK(read.seconds < 1);
  }
}

TEST_CASE("refuses large sparse files with an endless header") {
  const Read read = read_sparse("header.ply", "ply\nformat ascii 1.0\n");
  INFO(read.said);
  CHECK(read.said.find("a header line of more than 64 KiB") != std::string::npos);
  CHECK(read.seconds < 1);
}

}  // namespace gs::app::sparse_files_test

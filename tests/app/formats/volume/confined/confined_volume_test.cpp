#include "app/formats/volume/confined/confined_volume.h"

#include "app/base/local_file.h"
#include "app/confined/decoder_pool.h"
#include "app/formats/volume/confined/remote_volume.h"
#include "app/formats/volume/confined/volume_transfer.h"
#include "tests/app/formats/box_checks.h"
#include "tests/app/program.h"
#include "tests/app/volume_files.h"

#include <catch2/catch.hpp>

#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {
namespace confined_volume_test {

namespace fs = std::filesystem;
using Opened = std::variant<qnv::VolumeSource, std::string>;

struct WithVolumes {
  explicit WithVolumes(const std::string& of = program()) { set_decoder_program(of); }
  ~WithVolumes() { set_decoder_program({}); }
};

// Returns the processes that this thread started.
std::vector<pid_t> children() {
  std::ifstream list("/proc/self/task/" + std::to_string(::gettid()) + "/children");
  std::vector<pid_t> all;
  for (pid_t child = 0; list >> child;) all.push_back(child);
  return all;
}

std::vector<std::byte> bytes_of(const Opened& opened) { return transfer_bytes(VolumeReply{opened, 0}); }

std::vector<std::byte> slice_of(const qnv::VolumeSource& source, std::uint32_t z) {
  std::vector<std::byte> slice(qnv::slice_voxels(source.layout) * qnv::size_of(source.layout.type));
  if (!source.read(z, slice)) slice.clear();
  return slice;
}

void check_equal_slices(const qnv::VolumeSource& here, const qnv::VolumeSource& there) {
  const auto ours = numbered_sources(here), theirs = numbered_sources(there);
  REQUIRE(ours.size() == theirs.size());
  for (std::size_t i = 0; i < ours.size(); ++i)
    for (std::uint32_t z = 0; z < ours[i]->layout.dimensions[2]; ++z)
      REQUIRE(slice_of(*ours[i], z) == slice_of(*theirs[i], z));
  for (std::size_t i = 0; i < ours.size(); ++i) {
    CHECK((ours[i]->read_box != nullptr) == (theirs[i]->read_box != nullptr));
    if (theirs[i]->read_box) test::check_boxes(*theirs[i]);
  }
}

/// Opens a file here and in a child. Both must give the same volume or the same error.
Opened check_equal(const std::string& path, const RawVolume& raw = {}, const VoxelComponent& component = {}) {
  const VolumeOrigin origin{{}, {}, component};
  const Opened here = open_volume(path, raw, origin);
  const WithVolumes volumes;
  Opened there = open_volume_confined(path, raw, origin);
  CHECK(bytes_of(there) == bytes_of(here));
  const auto* const volume = std::get_if<qnv::VolumeSource>(&here);
  if (volume && std::holds_alternative<qnv::VolumeSource>(there) && qnv::voxel_count(volume->layout) < 1 << 20)
    check_equal_slices(*volume, std::get<qnv::VolumeSource>(there));
  return there;
}

std::string error_of(const Opened& opened) {
  const auto* const error = std::get_if<std::string>(&opened);
  return error ? *error : "";
}

// Writes a NRRD file with voxels of `numbers` components. The bytes depend on their places.
std::string large_nrrd(const ScratchFolder& folder, const std::string& name, std::uint32_t side, std::uint32_t slices,
                       std::uint32_t numbers = 1, bool beside = false) {
  std::string voxels(std::size_t{side} * side * slices * numbers, '\0');
  for (std::size_t i = 0; i < voxels.size(); ++i) voxels[i] = static_cast<char>(i * 2654435761u >> 13);
  const std::string size = std::to_string(side) + " " + std::to_string(side) + " " + std::to_string(slices);
  std::string header = "NRRD0004\ntype: uchar\ndimension: " + std::string(numbers > 1 ? "4" : "3") +
                       "\nsizes: " + (numbers > 1 ? std::to_string(numbers) + " " : "") + size + "\nencoding: raw\n" +
                       (numbers > 1 ? "kinds: vector domain domain domain\n" : "");
  if (!beside) return folder.write(name, header + "\n" + voxels);
  (void)folder.write(name + ".raw", voxels);
  return folder.write(name, header + "data file: " + name + ".raw\n");
}

TEST_CASE("a child opens volumes as this process does") {
  std::size_t opened = 0;
  for (const char* const format : {"avs_field", "nrrd", "metaimage", "nifti", "fits", "slc", "vtk_imagedata"})
    for (const auto& entry : fs::directory_iterator(std::string(GHOSTSPACE_TESTS "/fuzz/corpus/app/") + format)) {
      INFO(entry.path().string());
      opened += std::holds_alternative<qnv::VolumeSource>(check_equal(entry.path().string()));
    }
  CHECK(opened > 12);
  const ScratchFolder folder;
  const std::string path = folder.write("a.raw", std::string(60, 'a') + std::string(60, 'b'));
  RawVolume raw;
  raw.dimensions = {3, 4, 10};
  CHECK(error_of(check_equal(path, raw)).empty());
  CHECK(error_of(check_equal(path)).find("--dims") != std::string::npos);
  CHECK_FALSE(error_of(check_equal(folder.path("none.nrrd"))).empty());
  CHECK(error_of(check_equal(folder.write("empty.nrrd", ""))).find("is empty") != std::string::npos);
}

TEST_CASE("a child chooses components and steps as this process does") {
  const std::string corpus = GHOSTSPACE_TESTS "/fuzz/corpus/app/nrrd/";
  VoxelComponent magnitude, second, step, late;
  magnitude.magnitude = true;
  second.chosen = true;
  second.index = 1;
  step.step = qnv::ShownStep{1, {}};
  late.step = qnv::ShownStep{0, 1e9};
  for (const char* const name : {"vectors.nrrd", "colors.nrrd", "steps.nrrd"})
    for (const VoxelComponent& component : {magnitude, second, step, late})
      (void)check_equal(corpus + name, {}, component);
}

TEST_CASE("slices of a child are equal in any order of reading") {
  const ScratchFolder folder;
  for (const auto& [side, numbers] : {std::pair{40u, 1u}, {40u, 3u}, {900u, 3u}, {40u, 13u}}) {
    const std::string path = large_nrrd(folder, "v" + std::to_string(side * 16 + numbers) + ".nrrd", side, 40, numbers);
    const Opened here = open_volume(path);
    const WithVolumes volumes;
    const Opened there = open_volume_confined(path);
    REQUIRE(std::holds_alternative<qnv::VolumeSource>(there));
    const auto ours = numbered_sources(std::get<qnv::VolumeSource>(here)),
               theirs = numbered_sources(std::get<qnv::VolumeSource>(there));
    const auto check = [&](std::size_t source, std::uint32_t z) {
      REQUIRE(slice_of(*theirs[source], z) == slice_of(*ours[source], z));
    };
    for (std::uint32_t z = 0; z < 40; ++z) check(0, z);
    for (std::uint32_t z = 40; z-- > 0;) check(0, z);
    for (std::uint32_t z = 0; z < 40; z += 3) check(0, z);
    for (std::uint32_t z = 0; z < 40; ++z)
      for (std::size_t source = 0; source < ours.size(); ++source) check(source, z);
    std::uint32_t random = 1;
    for (int i = 0; i < 100; ++i) {
      random = random * 1664525 + 1013904223;
      check((random >> 8) % ours.size(), (random >> 16) % 40);
    }
    std::vector<std::byte> wrong(3);
    CHECK_FALSE(theirs[0]->read(0, wrong));
    CHECK(slice_of(*theirs[0], 40).empty());
  }
}

TEST_CASE("a child gets the files that a volume header names, large ones without copies") {
  const ScratchFolder folder;
  CHECK(error_of(check_equal(large_nrrd(folder, "small.nhdr", 10, 4, 1, true))).empty());
  CHECK(error_of(check_equal(large_nrrd(folder, "large.nhdr", 300, 30, 1, true))).empty());
  const std::string lost = large_nrrd(folder, "lost.nhdr", 10, 4, 1, true);
  fs::remove(folder.path("lost.nhdr.raw"));
  CHECK_FALSE(error_of(check_equal(lost)).empty());
  std::vector<std::string> asked;
  const ReadFile refuse = [&](const std::string& reference) -> BytesResult {
    asked.push_back(reference);
    return "refused: " + reference;
  };
  const WithVolumes volumes;
  const std::string error = error_of(open_volume_confined(lost, {}, {refuse, {}, {}}));
  CHECK(error.find("refused: lost.nhdr.raw") != std::string::npos);
  CHECK(asked == std::vector<std::string>{"lost.nhdr.raw"});
}

TEST_CASE("a killed child ends its volume only") {
  const ScratchFolder folder;
  const WithVolumes volumes;
  const std::string path = large_nrrd(folder, "a.nrrd", 200, 100);
  const auto before = children();
  auto opened = open_volume_confined(path);
  const auto other = open_volume_confined(path);
  auto& volume = std::get<qnv::VolumeSource>(opened);
  REQUIRE_FALSE(slice_of(volume, 0).empty());
  for (const pid_t child : children())
    if (std::ranges::find(before, child) == before.end()) {
      (void)::kill(child, SIGKILL);
      break;
    }
  // The child may give some slices before it is gone.
  std::uint32_t first = 50;
  while (first < 100 && !slice_of(volume, first).empty()) ++first;
  CHECK(first < 100);
  for (std::uint32_t z = first; z < 100; ++z) CHECK(slice_of(volume, z).empty());
  CHECK_FALSE(slice_of(std::get<qnv::VolumeSource>(other), 50).empty());
  opened = std::string();
  CHECK(std::holds_alternative<qnv::VolumeSource>(open_volume_confined(path)));
}

TEST_CASE("many open volumes share few children") {
  const ScratchFolder folder;
  const WithVolumes volumes;
  const std::size_t before = children().size();
  std::vector<qnv::VolumeSource> all;
  std::vector<std::string> paths;
  for (std::uint32_t i = 0; i < kMostVolumeChildren + 5; ++i) {
    paths.push_back(large_nrrd(folder, "v" + std::to_string(i) + ".nrrd", 100 + i, 20 + i));
    auto opened = open_volume_confined(paths.back());
    REQUIRE(std::holds_alternative<qnv::VolumeSource>(opened));
    all.push_back(std::move(std::get<qnv::VolumeSource>(opened)));
    CHECK(children().size() <= before + kMostVolumeChildren);
  }
  for (int turn = 0; turn < 2; ++turn)
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Opened here = open_volume(paths[i]);
      CHECK(slice_of(all[i], 7) == slice_of(std::get<qnv::VolumeSource>(here), 7));
      CHECK(children().size() <= before + kMostVolumeChildren);
    }
  all.clear();
  CHECK(children().size() == before);
}

TEST_CASE("a volume that changed while its child was ended is not read") {
  const ScratchFolder folder;
  const WithVolumes volumes;
  const std::string first = large_nrrd(folder, "first.nrrd", 300, 20);
  const auto opened = open_volume_confined(first);
  REQUIRE_FALSE(slice_of(std::get<qnv::VolumeSource>(opened), 0).empty());
  std::vector<Opened> others;
  for (std::size_t i = 0; i < kMostVolumeChildren; ++i) others.push_back(open_volume_confined(first));
  std::ofstream(first, std::ios::in | std::ios::out) << "NRRD0004\ntype: short";
  CHECK(slice_of(std::get<qnv::VolumeSource>(opened), 1).empty());
}

TEST_CASE("a child respects the budget of volumes") {
  const ScratchFolder folder;
  const std::string path =
      folder.write("zeros.raw.gz", gs::test::string_of(gs::test::gzipped(gs::test::Bytes(std::size_t{64} << 20))));
  RawVolume raw;
  raw.dimensions = {256, 256, 1024};
  Limits limits;
  limits.memory = std::size_t{16} << 20;
  const auto small = [&] { return std::make_shared<Budget>(limits); };
  const std::string here = error_of(open_volume(path, raw, {}, small()));
  const WithVolumes volumes;
  CHECK(error_of(open_volume_confined(path, raw, {}, small())) == here);
  CHECK(here.find("--memory") != std::string::npos);
  // The budget of this process counts what the child holds.
  const auto whole = own_budget();
  auto opened = open_volume_confined(path, raw, {}, whole);
  CHECK(std::holds_alternative<qnv::VolumeSource>(opened));
  CHECK(whole->used(Resource::volumes) >= std::size_t{64} << 20);
  opened = std::string();
  CHECK(whole->used(Resource::volumes) == 0);
}

/// Program that does not behave like a decoder: a shell script with the descriptors of one.
struct HostileProgram {
  ScratchFolder folder;
  std::string path;
  explicit HostileProgram(const std::string& text) : path(folder.write("program.sh", "#!/bin/sh\n" + text)) {
    (void)::chmod(path.c_str(), 0700);
  }
};

TEST_CASE("wrong answers of a child are errors") {
  const ScratchFolder folder;
  const std::string path = large_nrrd(folder, "a.nrrd", 10, 4);
  const auto problem = [&](const std::string& text) {
    const HostileProgram hostile(text);
    const WithVolumes volumes(hostile.path);
    return error_of(open_volume_confined(path));
  };
  const std::string skip = "head -c " + std::to_string(sizeof(DecodeRequest)) + " <&3 >/dev/null\n";
  CHECK(problem("exit 1\n").find("ended") != std::string::npos);
  CHECK(problem(skip + "kill -SEGV $$\n").find("ended by signal") != std::string::npos);
  CHECK_FALSE(problem(skip + "head -c 4000 /dev/zero >&3\nexec sleep 9\n").empty());
  CHECK_FALSE(problem(skip + "head -c 4000 /dev/zero | tr '\\0' '\\377' >&3\nexec sleep 9\n").empty());
  // An answer that announces a result and gives none: `good` is 1, at its place of the answer; `count` is huge.
  std::string answer(sizeof(DecodeAnswer), '\0');
  answer[offsetof(DecodeAnswer, good)] = 1;
  answer[offsetof(DecodeAnswer, count) + 7] = 1;
  const std::string file = folder.write("answer", answer);
  CHECK(problem(skip + "cat '" + file + "' >&3\nexec sleep 9\n").find("exceeds") != std::string::npos);
  answer[offsetof(DecodeAnswer, count) + 7] = 0;
  answer[offsetof(DecodeAnswer, count)] = 50;
  const std::string zeros = folder.write("zeros", answer);
  CHECK(problem(skip + "cat '" + zeros + "' >&3\nhead -c 1 <&3 >&3\nexec sleep 9\n").find("impossible result") !=
        std::string::npos);
}

TEST_CASE("a silent child does not delay a reader that is stopped") {
  const ScratchFolder folder;
  const std::string path = large_nrrd(folder, "a.nrrd", 10, 4);
  const HostileProgram hostile("exec sleep 30\n");
  const WithVolumes volumes(hostile.path);
  const auto budget = own_budget();
  const auto begin = std::chrono::steady_clock::now();
  budget->stop_when([begin] { return std::chrono::steady_clock::now() - begin > std::chrono::milliseconds(200); });
  CHECK_FALSE(error_of(open_volume_confined(path, {}, {}, budget)).empty());
  CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(5));
}

// Writes an array of bytes of OME-Zarr with one chunk per layer; the chunk of layer `missing` is not written.
void write_level(const ScratchFolder& folder, const std::string& name, int edge, int missing) {
  const std::string size = std::to_string(edge);
  folder.write(name + "/zarr.json",
               "{\"zarr_format\":3,\"node_type\":\"array\",\"data_type\":\"uint8\",\"shape\":[" + size + "," + size +
                   "," + size + "],\"chunk_grid\":{\"name\":\"regular\",\"configuration\":{\"chunk_shape\":[1," + size +
                   "," + size +
                   "]}},\"chunk_key_encoding\":{\"name\":\"default\"},\"fill_value\":9,\"codecs\":[{"
                   "\"name\":\"bytes\"}]}");
  for (int z = 0; z < edge; ++z) {
    std::string layer;
    for (int i = 0; i < edge * edge; ++i) layer += static_cast<char>(i * (z + 3));
    if (z == 2) layer.resize(5);  // damaged
    if (z != missing) folder.write(name + "/c/" + std::to_string(z) + "/0/0", layer);
  }
}

TEST_CASE("containers of Zarr are read in a child as in this process, with coarser levels and damaged chunks") {
  const ScratchFolder folder;
  folder.write(
      "image.zarr/zarr.json",
      "{\"zarr_format\":3,\"node_type\":\"group\",\"attributes\":{\"ome\":{\"version\":\"0.5\",\"multiscales\":[{"
      "\"axes\":[{\"name\":\"z\",\"type\":\"space\"},{\"name\":\"y\",\"type\":\"space\"},{\"name\":\"x\",\"type\":"
      "\"space\"}],\"datasets\":[{\"path\":\"0\",\"coordinateTransformations\":[{\"type\":\"scale\",\"scale\":[1,1,1]}]"
      "}"
      ",{\"path\":\"1\",\"coordinateTransformations\":[{\"type\":\"scale\",\"scale\":[2,2,2]}]}]}]}}}");
  write_level(folder, "image.zarr/0", 32, 7);
  write_level(folder, "image.zarr/1", 16, -1);
  for (const std::string& path : {folder.path("image.zarr"), folder.path("image.zarr/zarr.json")}) {
    const Opened there = check_equal(path);
    REQUIRE(std::holds_alternative<qnv::VolumeSource>(there));
    const auto& volume = std::get<qnv::VolumeSource>(there);
    REQUIRE(volume.coarser.size() == 1);
    CHECK(volume.coarser.front().layout.dimensions[0] == 16);
    CHECK(volume.coarser.front().layout.axes[0].x == 2);
    const auto missing = slice_of(volume, 7);
    CHECK(std::ranges::count(missing, std::byte{9}) == 32 * 32);
    CHECK(volume.trouble().find("/0: 1 chunk cannot be read") != std::string::npos);
    CHECK(volume.trouble().find("/1: 1 chunk cannot be read") != std::string::npos);
  }
}

// Replies of children, and what they name: a plain volume, colours, steps and an error.
std::vector<std::vector<std::byte>> replies() {
  std::vector<std::vector<std::byte>> all{transfer_bytes(VolumeReply{std::string("an error"), 7})};
  for (const char* const name : {"nrrd/raw.nrrd", "nrrd/colors.nrrd", "nrrd/steps.nrrd", "nifti/little.nii"})
    all.push_back(bytes_of(open_volume(std::string(GHOSTSPACE_TESTS "/fuzz/corpus/app/") + name)));
  return all;
}

bool has_sound_reply(std::span<const std::byte> bytes) {
  const auto reply = volume_reply_of(bytes, [](std::size_t, const qnv::VolumeLayout&) { return nullptr; });
  if (!reply) return false;
  if (const auto* const volume = std::get_if<qnv::VolumeSource>(&reply->volume)) {
    for (const qnv::VolumeSource* const source : numbered_sources(*volume)) {
      CHECK_FALSE(qnv::check(source->layout));
      CHECK(qnv::voxel_count(source->layout) <= qnv::voxel_count(volume->layout));
    }
    CHECK(volume->times.size() == volume->steps.size());
  }
  return true;
}

TEST_CASE("replies of volume children are not trusted: prefixes and changed bytes") {
  std::uint32_t random = 1;
  std::size_t taken = 0, refused = 0;
  for (const std::vector<std::byte>& bytes : replies()) {
    CHECK(has_sound_reply(bytes));
    for (std::size_t size = 0; size < bytes.size(); ++size) CHECK_FALSE(has_sound_reply(std::span(bytes).first(size)));
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      std::vector<std::byte> changed = bytes;
      changed[at] ^= static_cast<std::byte>(1u << at % 8);
      random = random * 1664525 + 1013904223;
      if (at % 3 == 0) changed[(random >> 8) % changed.size()] = static_cast<std::byte>(random >> 24);
      ++(has_sound_reply(changed) ? taken : refused);
    }
  }
  CHECK(taken > 0);
  CHECK(refused > 0);
}

TEST_CASE("requests for volumes survive prefixes and changed bytes") {
  VolumeRequest request;
  request.path = "a/b.nrrd";
  request.raw.spacing = {1, 2, 3};
  request.component.step = qnv::ShownStep{3, 1.5};
  request.left = {1, 2, 3};
  const auto bytes = transfer_bytes(request);
  const auto again = volume_request_of(bytes);
  REQUIRE(again);
  CHECK(transfer_bytes(*again) == bytes);
  CHECK(again->component == request.component);
  for (std::size_t size = 0; size < bytes.size(); ++size) CHECK_FALSE(volume_request_of(std::span(bytes).first(size)));
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    auto changed = bytes;
    changed[at] ^= std::byte{0xff};
    (void)volume_request_of(changed);
  }
}

}  // namespace confined_volume_test
}  // namespace gs::app

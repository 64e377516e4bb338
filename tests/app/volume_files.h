#pragma once

#include "app/formats/volume/volume.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "tests/app/formats_helpers.h"
#include "tests/app/scratch_folder.h"
#include "tests/gzip.h"

#include <catch2/catch.hpp>


#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <random>
#include <string>
#include <vector>

/// Helpers of tests of volume readers.
namespace gs::test {

using qnv::VoxelType;

/// Values of a 3 x 2 x 2 volume, some negative if the type allows.
inline constexpr std::array<int, 12> kValues = {0, 1, 2, 3, 40, 5, 6, 77, 8, 9, 100, 11};

template <class T>
Bytes voxels(bool big_endian) {
  Bytes bytes;
  for (const int value : kValues) {
    if (big_endian)
      put_big(bytes, static_cast<T>(value));
    else
      put(bytes, static_cast<T>(value));
  }
  return bytes;
}

inline Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

inline Bytes gzipped(const Bytes& bytes, int window = 31) { return test::deflated(bytes, window); }
inline Bytes zlib_packed(const Bytes& bytes) { return gzipped(bytes, 15); }

inline std::vector<float> values_of(const qnv::VolumeSource& source) {
  std::vector<float> all;
  std::vector<std::byte> scratch;
  std::vector<float> slice(qnv::slice_voxels(source.layout));
  for (std::uint32_t z = 0; z < source.layout.dimensions[2]; ++z) {
    REQUIRE(qnv::read_slice(source, z, scratch, slice));
    all.insert(all.end(), slice.begin(), slice.end());
  }
  return all;
}

inline qnv::VolumeSource opened(const std::string& path, const app::RawVolume& raw = {}) {
  auto result = app::open_volume(path, raw);
  if (const auto* problem = std::get_if<std::string>(&result)) FAIL(*problem);
  return std::get<qnv::VolumeSource>(std::move(result));
}

inline std::string problem_of(const std::string& path, const app::RawVolume& raw = {}) {
  const auto result = app::open_volume(path, raw);
  const auto* problem = std::get_if<std::string>(&result);
  return problem ? *problem : "";
}

inline void check_values(const qnv::VolumeSource& source, float slope = 1, float intercept = 0) {
  REQUIRE(source.layout.dimensions == std::array<std::uint32_t, 3>{3, 2, 2});
  const std::vector<float> values = values_of(source);
  for (std::size_t i = 0; i < kValues.size(); ++i)
    REQUIRE(values[i] == Approx(static_cast<float>(kValues[i]) * slope + intercept));
}

/// Checks that a file opens to a valid volume with readable slices, or to a message.
inline void check_sound(const std::string& path, const app::RawVolume& raw = {}) {
  const auto result = app::open_volume(path, raw);
  if (const auto* problem = std::get_if<std::string>(&result)) {
    REQUIRE(problem->starts_with(path));
    return;
  }
  const auto& source = std::get<qnv::VolumeSource>(result);
  REQUIRE_FALSE(qnv::check(source.layout));
  if (qnv::voxel_count(source.layout) > 1u << 20) return;
  (void)values_of(source);
}

inline void check_prefixes_and_flips(const ScratchFolder& folder, const std::string& name, const Bytes& bytes) {
  for (std::size_t n = 0; n < bytes.size(); ++n) check_sound(folder.write(name, string_of(bytes).substr(0, n)));
  std::mt19937 random(1);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    Bytes changed = bytes;
    changed[i] ^= static_cast<std::byte>(1u << random() % 8);
    if (i % 3 == 0) changed[random() % changed.size()] = static_cast<std::byte>(random());
    check_sound(folder.write(name, string_of(changed)));
  }
}

/// Does the same for formats that are decoded when a slice is read, so that damage may show late.
inline void check_late_damage(const ScratchFolder& folder, const std::string& name, const Bytes& bytes) {
  const auto check = [&](std::string_view damaged) {
    const std::string path = folder.write(name, damaged);
    const auto result = app::open_volume(path);
    if (const auto* problem = std::get_if<std::string>(&result)) {
      REQUIRE(problem->starts_with(path));
      return;
    }
    const auto& source = std::get<qnv::VolumeSource>(result);
    REQUIRE_FALSE(qnv::check(source.layout));
    if (qnv::voxel_count(source.layout) > 1u << 20) return;
    std::vector<std::byte> scratch;
    std::vector<float> slice(qnv::slice_voxels(source.layout));
    for (std::uint32_t z = 0; z < source.layout.dimensions[2]; ++z) (void)qnv::read_slice(source, z, scratch, slice);
  };
  for (std::size_t n = 0; n < bytes.size(); ++n) check(string_of(bytes).substr(0, n));
  std::mt19937 random(1);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    Bytes changed = bytes;
    changed[i] ^= static_cast<std::byte>(1u << random() % 8);
    check(string_of(changed));
  }
}

template <class T>
struct TypeNames {
  VoxelType type;
  const char *nrrd, *meta, *vti;
  bool wide = false;
};

template <class F>
inline void for_all_types(F&& check) {
  check(std::uint8_t{}, TypeNames<int>{VoxelType::u8, "uchar", "MET_UCHAR", "UInt8"});
  check(std::int8_t{}, TypeNames<int>{VoxelType::i8, "signed char", "MET_CHAR", "Int8"});
  check(std::uint16_t{}, TypeNames<int>{VoxelType::u16, "unsigned short", "MET_USHORT", "UInt16"});
  check(std::int16_t{}, TypeNames<int>{VoxelType::i16, "int16", "MET_SHORT", "Int16"});
  check(std::uint32_t{}, TypeNames<int>{VoxelType::u32, "uint32_t", "MET_UINT", "UInt32"});
  check(std::int32_t{}, TypeNames<int>{VoxelType::i32, "int", "MET_INT", "Int32"});
  check(float{}, TypeNames<int>{VoxelType::f32, "float", "MET_FLOAT", "Float32"});
  check(double{}, TypeNames<int>{VoxelType::f64, "double", "MET_DOUBLE", "Float64"});
  check(std::uint64_t{}, TypeNames<int>{VoxelType::f64, "uint64", "MET_ULONG_LONG", "UInt64", true});
  check(std::int64_t{}, TypeNames<int>{VoxelType::f64, "long long", "MET_LONG_LONG", "Int64", true});
}

inline void put_card(std::string& header, std::string card) {
  card.resize(80, ' ');
  header += card;
}

inline std::string fits(const std::vector<std::string>& cards, const Bytes& data) {
  std::string header;
  for (const std::string& card : cards) put_card(header, card);
  put_card(header, "END");
  header.resize((header.size() + 2879) / 2880 * 2880, ' ');
  std::string body = string_of(data);
  body.resize((body.size() + 2879) / 2880 * 2880, '\0');
  return header + body;
}

struct Nifti1 {  // Fields of nifti1.h at their offsets
  bool big_endian = false;
  Bytes bytes = Bytes(352);
  template <class T>
  void set(std::size_t at, T value) {
    Bytes raw;
    if (big_endian)
      put_big(raw, value);
    else
      put(raw, value);
    std::copy(raw.begin(), raw.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
  }
  Nifti1(bool big, std::int16_t type, std::int16_t bits, const char* magic, float offset) : big_endian(big) {
    set<std::int32_t>(0, 348);
    const std::array<std::int16_t, 8> dimensions = {3, 3, 2, 2, 1, 1, 1, 1};
    for (std::size_t i = 0; i < 8; ++i) set<std::int16_t>(40 + 2 * i, dimensions[i]);
    set<std::int16_t>(70, type);
    set<std::int16_t>(72, bits);
    for (std::size_t i = 0; i < 4; ++i) set<float>(76 + 4 * i, i == 0 ? 1.0f : static_cast<float>(i) + 0.5f);
    set<float>(108, offset);
    std::memcpy(bytes.data() + 344, magic, 4);
  }
};

inline const std::string kAvs =
    "# AVS field file\nndim=3\ndim1=3 # x\ndim2=2\ndim3=2\nnspace=3\nveclen=1\nfield=uniform\nlabel=density\ndata=";

inline std::string vti(const std::string& array, const std::string& appended, const std::string& attributes) {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" " + attributes +
         ">\n<ImageData WholeExtent=\"1 3 0 1 0 1\" Origin=\"5 6 7\" Spacing=\"1 2 3\">\n<Piece Extent=\"1 3 0 1 0 "
         "1\">\n"
         "<PointData Scalars=\"s\">\n" +
         array + "</PointData>\n<CellData/>\n</Piece>\n</ImageData>\n" + appended + "</VTKFile>\n";
}

template <class Word>
Bytes words(bool big_endian, std::initializer_list<std::size_t> numbers) {
  Bytes bytes;
  for (const std::size_t number : numbers)
    big_endian ? put_big(bytes, static_cast<Word>(number)) : put(bytes, static_cast<Word>(number));
  return bytes;
}

}  // namespace gs::test

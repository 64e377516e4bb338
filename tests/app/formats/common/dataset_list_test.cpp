#include "app/formats/common/dataset_list.h"

#include "app/formats/common/color_key.h"
#include "app/formats/common/transfer.h"

#include <catch2/catch.hpp>

#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace gs::app::dataset_list_test {
namespace {

DatasetList sample_list() {
  DatasetList list;
  DatasetEntry entry;
  entry.path = "/fields/velocity";
  entry.shape = {4, 5, 6, 3};
  entry.type = "3 x f32";
  entry.unit = "m/s";
  entry.form = DatasetForm::volume;
  list.entries = {entry, DatasetEntry{"/x", {6}, "f64"}};
  list.entries[1].is_minor = true;
  list.shown = entry.path;
  list.components = 3;
  list.component_names = {"u", "v", "w"};
  list.channels = 2;
  list.times = {0, 0.5, 2};
  list.range = {-1, 4};
  return list;
}

std::vector<std::byte> bytes_of(const DatasetList& list) {
  TransferWriter to;
  write_datasets(to, list);
  return to.take();
}

}  // namespace

TEST_CASE("hands lists of datasets to another process") {
  const DatasetList list = sample_list();
  const std::vector<std::byte> bytes = bytes_of(list);
  TransferReader from(bytes);
  const DatasetList read = read_datasets(from);
  CHECK(from.empty());
  REQUIRE(read.entries.size() == 2);
  CHECK(read.entries[0].path == "/fields/velocity");
  CHECK(read.entries[0].shape == list.entries[0].shape);
  CHECK(read.entries[0].unit == "m/s");
  CHECK(read.entries[0].form == DatasetForm::volume);
  CHECK(read.entries[1].is_minor);
  CHECK(read.shown == list.shown);
  CHECK(read.component_names == list.component_names);
  CHECK(read.components == 3);
  CHECK(read.channels == 2);
  CHECK(read.times == list.times);
  CHECK(read.range == list.range);
}

TEST_CASE("rejects invalid lists of datasets from a child") {
  const std::vector<std::byte> bytes = bytes_of(sample_list());
  const std::span<const std::byte> all(bytes);
  for (std::size_t n = 0; n < all.size(); ++n) {
    TransferReader from(all.first(n));
    CHECK_THROWS_AS(read_datasets(from), Impossible);
  }
  DatasetList list = sample_list();
  list.times[1] = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::byte> wrong = bytes_of(list);
  TransferReader from(wrong);
  CHECK_THROWS_AS(read_datasets(from), Impossible);
}

TEST_CASE("colours values over the whole range, without outliers, or between typed values") {
  std::vector<float> values;
  for (int i = 0; i <= 100; ++i) values.push_back(static_cast<float>(i));
  values.push_back(std::numeric_limits<float>::quiet_NaN());
  VoxelComponent choice;
  choice.found = std::make_shared<DatasetList>();
  const auto range_of = [&] {
    const ColorKey key = color_key_of_choice(values, "T", choice);
    return std::pair(key.low, key.high);
  };
  CHECK(range_of() == std::pair(0.0, 100.0));
  choice.colors.range = SurfaceColors::Range::contrast;
  CHECK(range_of() == std::pair(2.0, 98.0));
  choice.colors.range = SurfaceColors::Range::typed;
  choice.colors.low = 10;
  choice.colors.high = 20;
  CHECK(range_of() == std::pair(10.0, 20.0));
  CHECK(choice.found->range == std::pair(0.0, 100.0));
  choice.colors.map = {{0, 0, 0}, {1, 1, 1}};
  CHECK(color_key_of_choice(values, "T", choice).colors.back() == vrml::Color{1, 1, 1});
}

}  // namespace gs::app::dataset_list_test

#pragma once

#include "app/base/read_files.h"
#include "app/formats/datasets/zarr/zarr_metadata.h"
#include "base/budget.h"

#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// Reader of an array that keeps decoded chunks. Any thread; one at a time works.
class ZarrReader {
 public:
  /// `folder` is the reference of the folder of the array, empty or with '/' at its end. The memory of chunks is
  /// charged to `budget`.
  ZarrReader(std::string folder, ZarrArray array, ReadFiles read, WorldBudget budget);

  [[nodiscard]] const ZarrArray& array() const { return array_; }
  /// Reads the box of elements that begins at `first` and has `count` elements per dimension, in native byte order; the
  /// last dimension varies fastest. `to` must have the size of the box. Chunks that do not exist have the fill value,
  /// as the specifications say. Chunks that cannot be read have NaN, or the fill value if they are integers, and are
  /// counted. Returns false if the budget does not suffice, or the read was stopped.
  [[nodiscard]] bool read(std::span<const std::uint64_t> first, std::span<const std::uint64_t> count,
                          std::span<std::byte> to);
  /// Returns a message about chunks that could not be read so far; empty if there are none.
  [[nodiscard]] std::string trouble() const;

 private:
  using Key = std::vector<std::uint64_t>;  // index of a chunk in each dimension
  struct Chunk {
    std::vector<std::byte> elements;  // empty for a chunk that does not exist
    bool failed = false;
    Share share;
  };
  using Entry = std::pair<Key, Chunk>;
  struct Index {
    std::vector<std::pair<std::uint64_t, std::uint64_t>> places;  // offset and bytes of each chunk in a shard
    std::string problem;
    bool absent = false;
  };

  /// Brings the chunks into memory, some of them at once. Returns the number that fits.
  [[nodiscard]] std::size_t fetch(std::span<const Key> keys);
  [[nodiscard]] bool keep(const Key& key, FileResult file);
  void decode(const Key& key, FileResult file, Chunk& chunk);
  [[nodiscard]] const Chunk* find(const Key& key);
  [[nodiscard]] std::string file_of(const Key& key) const;
  /// Sets the request for a chunk. Returns the result at once if it is known without a request.
  [[nodiscard]] std::optional<FileResult> request(const Key& key, FileRequest& wanted);
  [[nodiscard]] const Index& index_of(const Key& shard);
  void copy(std::span<const std::uint64_t> first, std::span<const std::uint64_t> count, const Key& key,
            const Chunk& chunk, std::span<std::byte> to) const;
  void note(const std::string& file, const std::string& problem);

  std::string folder_;
  ZarrArray array_;
  ReadFiles read_;
  WorldBudget budget_;
  std::vector<std::uint64_t> strides_;  // of the dimensions in a whole chunk, in elements
  std::vector<std::byte> bad_;          // element of chunks that cannot be read
  mutable std::mutex mutex_;
  std::list<Entry> chunks_;  // the most recently used first
  std::map<Key, std::list<Entry>::iterator> places_;
  std::map<Key, Index> indices_;
  std::uint64_t failed_ = 0;
  std::string first_problem_;
};

}  // namespace gs::app

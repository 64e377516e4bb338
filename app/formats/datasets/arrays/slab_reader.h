#pragma once

#include "app/formats/datasets/arrays/dataset_tree.h"

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace gs::app {

/// Slice of an array: all elements of two or three axes, one index of each other axis.
struct ArraySlice {
  std::size_t array = 0;
  std::vector<std::uint64_t> first, count;  // of the slice; `count` is 1 along `along`
  std::optional<std::size_t> along;         // axis along which neighbouring slices are read, too
};

/// Reads slices of arrays. Reads a layer of neighbouring slices at once, because chunks hold several, and keeps the
/// last layers within the budget. Any thread.
class SlabReader {
 public:
  explicit SlabReader(const DatasetTree& tree);

  /// Returns the bytes of a slice, in the order of the axes of the array. The result is empty on failure. It shares the
  /// layer.
  [[nodiscard]] std::shared_ptr<const std::vector<std::byte>> read(const ArraySlice& slice, std::size_t& offset,
                                                                   std::vector<std::uint64_t>& counts);

  /// Reads a box of an array into `to`, without keeping it. Returns false on failure.
  [[nodiscard]] bool read_part(std::size_t array, std::span<const std::uint64_t> first,
                               std::span<const std::uint64_t> count, std::vector<std::byte>& to);
  /// Reports whether a server has the file, so that it is received by parts.
  [[nodiscard]] bool by_parts() const { return content_.need != nullptr; }
  /// Receives the bytes of several boxes at once. Reading the boxes reports problems.
  void prepare(std::size_t array, std::span<const ArrayBox> boxes);
  /// Lets the pages of a large file leave memory.
  void put_aside();
  /// Returns the edges of the chunks of an array; none if it has no chunks.
  [[nodiscard]] const std::vector<std::uint64_t>& chunk(std::size_t array) const {
    return file_->arrays()[array].chunk;
  }

 private:
  struct Slab {
    std::size_t array = 0;
    std::vector<std::uint64_t> first, count;
    std::shared_ptr<const std::vector<std::byte>> bytes;
  };

  std::mutex mutex_;
  std::shared_ptr<ArrayFile> file_;
  SharedBytes content_;
  WorldBudget budget_;
  std::size_t most_bytes_ = 0;  // of all layers
  Share share_;
  std::list<Slab> slabs_;  // the last one used first
};

}  // namespace gs::app

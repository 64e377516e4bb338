#pragma once

#include "vrml/scene/scene_memory.h"
#include "vrml/scene/source_text.h"

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml {

/// Texts of a scene by index: 0 is the file, the others are run-time texts. A run-time text is freed with the last of
/// its nodes; then its index is used again. One thread.
class SceneTexts {
 public:
  /// `file` and `memory` must outlive the object.
  SceneTexts(SourceText& file, SceneMemory& memory);
  SceneTexts(const SceneTexts&) = delete;
  SceneTexts& operator=(const SceneTexts&) = delete;

  /// Returns the text for which nodes are made: the file or a run-time text.
  [[nodiscard]] SourceText& writing() { return *text_; }
  /// Returns the index of writing().
  [[nodiscard]] std::uint32_t writing_index() const { return writing_; }
  [[nodiscard]] SourceText& at(std::uint32_t index) { return index == 0 ? file_ : *texts_[index].text; }
  [[nodiscard]] const SourceText& at(std::uint32_t index) const { return index == 0 ? file_ : *texts_[index].text; }
  /// Returns the index of the text that declares a type; 0 for the file. The type may have been deleted. Returns
  /// nullopt if no text declares it.
  [[nodiscard]] std::optional<std::uint32_t> declaring(const NodeType* type) const;
  /// Returns the number of run-time texts in memory.
  [[nodiscard]] std::size_t run_time_count() const { return texts_.size() - 1 - free_.size(); }
  /// Returns a copy of `name` that lives as long as writing().
  const std::string* keep_name(std::string_view name);

  /// Makes the text with this index the one for which nodes are made. Returns the index of the former one.
  std::uint32_t write_for(std::uint32_t index);
  /// Adds a run-time text and returns its index. It is not freed before close(). `written_by` is the text that
  /// requested the text. `fetched_from` is the source of a text that was read from a URL; null means that a Script
  /// computed the text.
  [[nodiscard]] std::uint32_t open(std::string file_name, const SourceText& written_by,
                                   std::shared_ptr<const TextSource> fetched_from);
  void close(std::uint32_t index) { texts_[index].open = false; }
  // Functions that count the nodes of run-time texts, except those of PROTO bodies. They ignore the file. remove_node()
  // returns true after the last node of a run-time text.
  void add_node(std::uint32_t index) {
    if (index != 0) ++texts_[index].nodes;
  }
  bool remove_node(std::uint32_t index) { return index != 0 && --texts_[index].nodes == 0; }
  /// Reports whether a run-time text is closed and has no nodes. Returns false for the file and for free indices.
  [[nodiscard]] bool is_unused(std::uint32_t index) const {
    return texts_[index].text && texts_[index].nodes == 0 && !texts_[index].open;
  }
  /// Frees an unused run-time text.
  void erase(std::uint32_t index);

 private:
  /// Run-time text, and the resources that it owns.
  struct OwnedText {
    std::unique_ptr<SourceText> text;  // null if the index is free
    std::size_t nodes = 0;             // number of nodes made for it, except those of PROTO bodies
    TextAccount account;
    bool open = false;  // is being read
  };

  SourceText& file_;
  SceneMemory& memory_;
  std::deque<OwnedText> texts_;  // index 0 is unused, because it is the file
  std::vector<std::uint32_t> free_;
  std::uint32_t writing_ = 0;
  SourceText* text_;  // the text with the index writing_
};

}  // namespace gs::vrml

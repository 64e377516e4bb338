#include "vrml/scene/scene_texts.h"

#include <algorithm>
#include <utility>

namespace gs::vrml {

SceneTexts::SceneTexts(SourceText& file, SceneMemory& memory) : file_(file), memory_(memory), texts_(1), text_(&file) {}

std::optional<std::uint32_t> SceneTexts::declaring(const NodeType* type) const {
  const auto is_it = [type](const auto& one) { return one.get() == type; };
  for (std::uint32_t i = 0; i < texts_.size(); ++i)
    if (i == 0 || texts_[i].text)
      if (const auto& types = at(i).types(); std::any_of(types.begin(), types.end(), is_it)) return i;
  return std::nullopt;
}

const std::string* SceneTexts::keep_name(std::string_view name) {
  constexpr std::size_t kEntry = 96;  // bytes of an entry here and in the scope that looks it up
  (void)memory_.charge(name.size() + kEntry);
  return &writing().names_.emplace_front(name);
}

std::uint32_t SceneTexts::write_for(std::uint32_t index) {
  text_ = &at(index);
  memory_.set_account(index == 0 ? nullptr : &texts_[index].account);
  return std::exchange(writing_, index);
}

std::uint32_t SceneTexts::open(std::string file_name, const SourceText& written_by,
                               std::shared_ptr<const TextSource> fetched_from) {
  if (free_.empty()) {
    free_.push_back(static_cast<std::uint32_t>(texts_.size()));
    texts_.emplace_back();
  }
  const std::uint32_t index = free_.back();
  free_.pop_back();
  OwnedText& made = texts_[index];
  made.text = std::make_unique<SourceText>(std::move(file_name));
  made.text->origin_ = &written_by.origin();
  made.text->set_language(written_by.language(), written_by.version());
  made.text->computed_ = fetched_from == nullptr;
  made.text->source_ = fetched_from ? std::move(fetched_from) : written_by.source();
  made.open = true;
  if (constexpr std::size_t kBytes = sizeof(SourceText) + sizeof(OwnedText); memory_.draw(kBytes))
    made.account.charged += kBytes;
  return index;
}

void SceneTexts::erase(std::uint32_t index) {
  memory_.give_back(texts_[index].account);
  texts_[index] = {};
  free_.push_back(index);
}

}  // namespace gs::vrml

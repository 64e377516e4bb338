#include "app/script/boundary/message.h"

#include <algorithm>
#include <utility>

// Field values in messages.
namespace gs::app::script {
namespace {

template <class T>
constexpr bool kIsPlain = std::is_trivially_copyable_v<T> && !std::is_same_v<T, bool>;

void write_part(MessageWriter& to, bool value) { to.number(static_cast<std::uint8_t>(value)); }
void write_part(MessageWriter& to, const vrml::String& text) { to.text(text.view()); }
void write_part(MessageWriter& to, const vrml::PixelImage& image) {
  to.number(static_cast<std::uint64_t>(image.words.size()));
  to.raw(image.words.data(), image.words.size() * sizeof(std::uint32_t));
}
template <class T>
requires kIsPlain<T>
void write_part(MessageWriter& to, const T& value) { to.raw(&value, sizeof value); }
template <class T, int kInitial>
void write_part(MessageWriter& to, const Boxed<T, kInitial>& value) {
  to.raw(&*value, sizeof(T));
}
template <class T>
void write_part(MessageWriter& to, const Array<T>& array) {
  to.number(static_cast<std::uint64_t>(array.size()));
  if constexpr (kIsPlain<T>) {
    to.raw(array.data(), array.size() * sizeof(T));
  } else {
    for (const T& one : array) write_part(to, one);
  }
}

void read_part(MessageReader& from, bool& value) { value = from.truth(); }
void read_part(MessageReader& from, vrml::String& text) { text = vrml::String(from.text()); }
void read_part(MessageReader& from, vrml::PixelImage& image) {
  constexpr std::size_t kHead = 3;  // width, height, components
  constexpr std::uint32_t kMostComponents = 4;
  const std::size_t words = from.count(sizeof(std::uint32_t));
  image.words.resize(words);
  from.raw(image.words.mutable_data(), words * sizeof(std::uint32_t));
  const bool fits = words == 0 || (words >= kHead && image.components() <= kMostComponents &&
                                   std::uint64_t{image.width()} * image.height() == words - kHead);
  if (from.good() && fits) return;
  from.fail();
  image = {};
}
template <class T>
requires kIsPlain<T>
void read_part(MessageReader& from, T& value) { from.raw(&value, sizeof value); }
template <class T, int kInitial>
void read_part(MessageReader& from, Boxed<T, kInitial>& value) {
  T plain(kInitial);
  from.raw(&plain, sizeof plain);
  value = Boxed<T, kInitial>(plain);
}
template <class T>
void read_part(MessageReader& from, Array<T>& array) {
  constexpr std::size_t kLeast = kIsPlain<T> ? sizeof(T) : std::is_same_v<T, bool> ? 1 : sizeof(std::uint32_t);
  const std::size_t count = from.count(kLeast);
  array.resize(count);
  if constexpr (kIsPlain<T>) {
    from.raw(array.mutable_data(), count * sizeof(T));
  } else {
    T* const elements = array.mutable_data();
    for (std::size_t i = 0; i < count && from.good(); ++i) read_part(from, elements[i]);
  }
}

}  // namespace

void MessageWriter::text(std::string_view text) {
  number(static_cast<std::uint32_t>(text.size()));
  raw(text.data(), text.size());
}

std::uint32_t MessageReader::below(std::uint32_t count) {
  const auto value = number<std::uint32_t>();
  if (value < count) return value;
  fail();
  return 0;
}

std::string MessageReader::text() {
  const auto bytes = number<std::uint32_t>();
  if (bytes > rest_.size()) {
    fail();
    return {};
  }
  std::string text(reinterpret_cast<const char*>(rest_.data()), bytes);
  rest_ = rest_.subspan(bytes);
  return text;
}

std::size_t MessageReader::count(std::size_t bytes) {
  const auto count = number<std::uint64_t>();
  if (count <= rest_.size() / bytes) return static_cast<std::size_t>(count);
  fail();
  return 0;
}

void write(MessageWriter& to, const vrml::FieldValue& value) {
  to.number(static_cast<std::uint8_t>(value.index()));
  std::visit([&](const auto& part) { write_part(to, part); }, value);
}

vrml::FieldValue read_value(MessageReader& from) {
  const auto type = from.number<std::uint8_t>();
  if (type >= vrml::kFieldTypeCount) {
    from.fail();
    return {};
  }
  vrml::FieldValue value = vrml::initial_value(static_cast<vrml::FieldType>(type));
  std::visit([&](auto& part) { read_part(from, part); }, value);
  if (!from.good()) return {};
  return value;
}

}  // namespace gs::app::script

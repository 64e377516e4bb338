#include "vrml/json/list_reader.h"

#include "vrml/scene/values/field_numbers.h"
#include "vrml/syntax/numbers/number.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>

namespace gs::vrml::json {
namespace {

// Numbers on the stack, so that memory for short lists is allocated once, with the exact size.
constexpr std::size_t kShortRun = 720;
constexpr std::size_t kLongRun = 16 * 1024;  // elements

template <class T>
constexpr bool is_float_list = false;
template <class T>
requires NumberElement<T>
constexpr bool is_float_list<Array<T>> = std::is_same_v<typename ElementNumbers<T>::Number, float>;

std::size_t arity_of(const FieldValue& value) {
  return std::visit(
      []<class T>(const T&) -> std::size_t {
        if constexpr (NumberElement<ElementOf<T>>) return ElementNumbers<ElementOf<T>>::kCount;
        return 0;
      },
      value);
}

}  // namespace

bool ListReader::read_short(FieldValue& into, Lexer& lexer) {
  const char* const end = lexer.window_end();
  const auto read = [&]<class T>(T& value) {
    if constexpr (NumberElement<ElementOf<T>>) {
      using Element = ElementOf<T>;
      using Number = typename ElementNumbers<Element>::Number;
      constexpr std::size_t kArity = ElementNumbers<Element>::kCount;
      constexpr bool kIsList = requires { value.push_back(Element{}); };
      if constexpr (!std::is_same_v<Number, double>) {
        alignas(16) Number buffer[kIsList ? kShortRun : kArity];
        NumberRun run;
        if constexpr (std::is_same_v<Number, float>)
          run = parse_floats(lexer.unread(), end, buffer, std::size(buffer));
        else
          run = parse_integers(lexer.unread(), end, buffer, std::size(buffer));
        const bool fits = kIsList ? run.count % kArity == 0 : run.count == kArity;
        if (!fits || run.next == end || *run.next != ']') return false;
        lexer.advance(run.next + 1, run.lines, run.line_start);
        const auto* const elements = reinterpret_cast<const Element*>(buffer);
        if constexpr (kIsList)
          value = T(std::span<const Element>(elements, run.count / kArity));
        else
          value = *elements;
        return true;
      }
    }
    return false;
  };
  if (!std::visit(read, into)) return false;
  std::size_t charged = 0;
  sink_.limits().charge_growth(into, charged, true);
  return true;
}

bool ListReader::read_plain_word(std::string_view word, FieldValue& into) {
  if (auto* const number = std::get_if<SFFloat>(&into)) return parse_number(word, *number);
  if (auto* const number = std::get_if<SFInt32>(&into)) return parse_number(word, *number);
  if (auto* const flag = std::get_if<SFBool>(&into); flag && (word == "true" || word == "false")) {
    *flag = word == "true";
    return true;
  }
  return false;
}

void ListReader::begin(FieldValue& into, std::string_view name, SourceLocation location) {
  into_ = &into;
  name_ = name;
  location_ = location;
  partial_count_ = count_ = charged_ = 0;
  said_ = false;
  arity_ = arity_of(into);
  is_image_ = false;
  std::visit(
      [&]<class T>(T& value) {
        if constexpr (std::is_same_v<ElementOf<T>, SFImage>) is_image_ = true;
        if constexpr (requires { value.push_back(ElementOf<T>{}); }) value.clear();
      },
      into);
  words_ = MFInt32{};
}

template <class T>
void ListReader::read_floats(Lexer& lexer, Array<T>& list) {
  constexpr std::size_t kArity = ElementNumbers<T>::kCount;
  const auto take = [&](float* at, std::size_t capacity) {
    for (std::size_t i = 0; i < partial_count_; ++i) at[i] = static_cast<float>(partial_[i]);
    const NumberRun run =
        parse_floats(lexer.unread(), lexer.window_end(), at + partial_count_, capacity - partial_count_);
    lexer.advance(run.next, run.lines, run.line_start);
    const std::size_t count = run.count + partial_count_;
    partial_count_ = count % kArity;
    for (std::size_t i = 0; i < partial_count_; ++i) partial_[i] = at[count - partial_count_ + i];
    return std::pair(count / kArity, count == capacity);
  };
  alignas(16) float buffer[kShortRun];
  auto [elements, full] = take(buffer, kShortRun);
  list.append(std::span<const T>(reinterpret_cast<const T*>(buffer), elements));
  while (full) {
    T* const at = list.prepare(kLongRun);
    std::tie(elements, full) = take(reinterpret_cast<float*>(at), kLongRun * kArity);
    list.commit(elements);
  }
}

void ListReader::read_integers(Lexer& lexer, MFInt32& list) {
  std::int32_t buffer[kShortRun];
  NumberRun run = parse_integers(lexer.unread(), lexer.window_end(), buffer, kShortRun);
  lexer.advance(run.next, run.lines, run.line_start);
  list.append(std::span<const std::int32_t>(buffer, run.count));
  bool full = run.count == kShortRun;
  while (full) {
    run = parse_integers(lexer.unread(), lexer.window_end(), list.prepare(kLongRun), kLongRun);
    lexer.advance(run.next, run.lines, run.line_start);
    list.commit(run.count);
    full = run.count == kLongRun;
  }
}

void ListReader::read_plain(Lexer& lexer) {
  if (is_image_) {
    read_integers(lexer, *std::get_if<MFInt32>(&words_));
    sink_.limits().charge_growth(words_, charged_, false);
    return;
  }
  std::visit(
      [&]<class T>(T& value) {
        if constexpr (is_float_list<T>) read_floats(lexer, value);
        if constexpr (std::is_same_v<T, MFInt32>) read_integers(lexer, value);
      },
      *into_);
  sink_.limits().charge_growth(*into_, charged_, false);
}

double ListReader::number_of(std::string_view word, SourceLocation location) {
  float single = 0;
  double number = 0;
  std::int32_t integer = 0;
  if (is_image_ || std::holds_alternative<MFInt32>(*into_) || std::holds_alternative<SFInt32>(*into_)) {
    if (parse_number(word, integer)) return integer;
    if (parse_number(word, number) && !std::isnan(number)) {
      if (number != std::trunc(number) || number < 0 || number >= 4294967296.0)
        sink_.problems().warn_once(said_integer_, location,
                                   "expected an integer of 32 bits, found " + quoted(word) + "; converted");
      return std::trunc(number);
    }
  } else {
    const bool is_double = std::visit(
        []<class T>(const T&) {
          if constexpr (NumberElement<ElementOf<T>>)
            return std::is_same_v<typename ElementNumbers<ElementOf<T>>::Number, double>;
          return false;
        },
        *into_);
    if (is_double ? parse_number(word, number) : parse_number(word, single)) return is_double ? number : single;
    if (parse_number(word, integer)) return integer;
  }
  if (!std::exchange(said_, true))
    sink_.problems().error(location, "expected a number for " + name_ + ", found " + quoted(word) + "; 0 is used");
  return 0;
}

void ListReader::add_number(double number) {
  const auto integer = [&] {
    return number > 2147483647.0 && number < 4294967296.0
               ? static_cast<std::int32_t>(static_cast<std::uint32_t>(number))
               : static_cast<std::int32_t>(std::clamp(number, -2147483648.0, 2147483647.0));
  };
  if (is_image_) return std::get_if<MFInt32>(&words_)->push_back(integer());
  partial_[partial_count_++] = number;
  if (partial_count_ < arity_) return;
  partial_count_ = 0;
  ++count_;
  std::visit(
      [&]<class T>(T& value) {
        using Element = ElementOf<T>;
        if constexpr (NumberElement<Element>) {
          Element element = element_from<Element>(partial_.data());
          if constexpr (std::is_same_v<Element, std::int32_t>) element = integer();
          if constexpr (requires { value.push_back(element); })
            value.push_back(element);
          else if (count_ == 1)
            value = element;
        }
      },
      *into_);
}

void ListReader::read_word(std::string_view word, SourceLocation location) {
  if (word == "null") return;
  if (arity_ > 0 || is_image_) return add_number(number_of(word, location));
  bool is_boolean = true;
  if (auto* strings = std::get_if<MFString>(into_)) return strings->push_back(values_.string_of(word, location));
  if (auto* string = std::get_if<SFString>(into_)) {
    *string = values_.string_of(word, location);
    return;
  }
  const bool yes = values_.boolean_of(word, location, is_boolean);
  if (!is_boolean && !std::exchange(said_, true))
    sink_.problems().error(location, "expected true or false for " + name_ + ", found " + quoted(word));
  std::visit(
      [&]<class T>(T& value) {
        if constexpr (std::is_same_v<T, SFBool>) {
          if (is_boolean) value = yes;
        } else if constexpr (std::is_same_v<T, Array<SFBool>>) {
          value.push_back(yes);
        }
      },
      *into_);
}

void ListReader::read_string(std::string_view text, SourceLocation location) {
  if (auto* strings = std::get_if<MFString>(into_)) return strings->push_back(values_.string_of(text, location));
  if (auto* string = std::get_if<SFString>(into_)) {
    *string = values_.string_of(text, location);
    return;
  }
  constexpr std::string_view kSeparators = " ,\t\r\n";
  for (std::size_t at = text.find_first_not_of(kSeparators); at < text.size();) {
    const std::size_t end = std::min(text.find_first_of(kSeparators, at), text.size());
    read_word(text.substr(at, end - at), location);
    at = text.find_first_not_of(kSeparators, end);
  }
}

// Makes an image from the numbers after `from`. Returns the position after its last number.
std::size_t ListReader::image_at(std::size_t from, SourceLocation location, SFImage& image) {
  const MFInt32& words = *std::get_if<MFInt32>(&words_);
  const std::size_t left = words.size() - from;
  image.words.clear();
  if (left < 3) {
    sink_.problems().error(location, "expected width, height and components of an image for " + name_);
    return words.size();
  }
  const std::int32_t width = words[from], height = words[from + 1], components = words[from + 2];
  if (!sink_.limits().admits_image(width, height, components, location)) return words.size();
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (pixels == 0 || components == 0) return from + 3;
  const std::size_t given = std::min(pixels, left - 3);
  const std::uint32_t mask = components == 4 ? 0xffffffffu : (1u << (8 * components)) - 1;
  image.words.reserve(3 + given);
  for (std::size_t i = 0; i < 3; ++i) image.words.push_back(static_cast<std::uint32_t>(words[from + i]));
  for (std::size_t i = 0; i < given; ++i) image.words.push_back(static_cast<std::uint32_t>(words[from + 3 + i]) & mask);
  if (given < pixels) {
    sink_.problems().error(location, std::to_string(pixels - given) + " pixels of an image are missing");
    // Few bytes of text may declare many pixels.
    if ((pixels - given) * sizeof(std::uint32_t) > sink_.scene().budget()->left(Resource::nodes) / 4)
      image.words.clear();
    else
      image.words.resize(3 + pixels);
  }
  (void)sink_.scene().memory().charge(image.words.size() * sizeof(std::uint32_t));
  return from + 3 + given;
}

void ListReader::end_images(SourceLocation location) {
  const std::size_t size = std::get_if<MFInt32>(&words_)->size();
  std::visit(
      [&]<class T>(T& value) {
        if constexpr (std::is_same_v<T, SFImage>) {
          if (size > 0) (void)image_at(0, location, value);
        } else if constexpr (std::is_same_v<T, Array<SFImage>>) {
          for (std::size_t at = 0; at < size && !sink_.scene().memory().exhausted();) {
            SFImage image;
            at = image_at(at, location, image);
            value.push_back(image);
          }
        }
      },
      *into_);
  words_ = MFInt32{};
}

void ListReader::end(SourceLocation location) {
  if (is_image_) return end_images(location);
  const bool is_list = is_multiple(type_of(*into_));
  const std::string expected = "; expected " + std::to_string(arity_);
  if (partial_count_ > 0 && is_list)
    sink_.problems().error(
        location, "the last value of " + name_ + " has " + std::to_string(partial_count_) + " numbers" + expected);
  if (arity_ > 0 && !is_list && (count_ != 1 || partial_count_ > 0))
    sink_.problems().error(location_,
                           name_ + " has " + std::to_string(count_ * arity_ + partial_count_) + " numbers" + expected);
  std::visit(
      [](auto& value) {
        if constexpr (requires { value.shrink_to_fit(); }) value.shrink_to_fit();
      },
      *into_);
  sink_.limits().charge_growth(*into_, charged_, true);
}

}  // namespace gs::vrml::json

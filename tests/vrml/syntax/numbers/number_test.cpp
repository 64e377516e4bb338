#include "vrml/syntax/numbers/number.h"
#include "base/noncopyable.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "tests/vrml/number_tokens.h"
#include "tests/watched.h"
#include "vrml/syntax/numbers/number_paths.h"

namespace {

using namespace gs::vrml;
using namespace gs::test;

template <class T>
struct Path {
  const char* name;
  NumberRun (*read)(const char*, const char*, T*, std::size_t);
};

std::vector<Path<float>> paths(float) {
  std::vector<Path<float>> all = {{"portable", number_paths::floats_portable}, {"chosen", parse_floats}};
  if (number_paths::has_avx2()) all.push_back({"avx2", number_paths::floats_avx2});
  return all;
}
std::vector<Path<std::int32_t>> paths(std::int32_t) {
  std::vector<Path<std::int32_t>> all = {{"portable", number_paths::integers_portable}, {"chosen", parse_integers}};
  if (number_paths::has_avx2()) all.push_back({"avx2", number_paths::integers_avx2});
  return all;
}

std::uint32_t bits_of(float value) { return std::bit_cast<std::uint32_t>(value); }
std::uint32_t bits_of(std::int32_t value) { return std::bit_cast<std::uint32_t>(value); }

/// Text between two unreadable pages.
class GuardedText : gs::NonCopyable {
 public:
  explicit GuardedText(std::size_t capacity) {
    page_ = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    size_ = (capacity + page_ - 1) / page_ * page_;
    void* memory = mmap(nullptr, size_ + 2 * page_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    REQUIRE(memory != MAP_FAILED);
    base_ = static_cast<char*>(memory);
    REQUIRE(mprotect(base_ + page_, size_, PROT_READ | PROT_WRITE) == 0);
  }
  ~GuardedText() { munmap(base_, size_ + 2 * page_); }

  /// Returns the text directly before the unreadable page.
  std::string_view at_end(std::string_view text) {
    char* const begin = base_ + page_ + size_ - text.size();
    std::copy(text.begin(), text.end(), begin);
    return {begin, text.size()};
  }
  /// Returns the text directly after the unreadable page.
  std::string_view at_start(std::string_view text) {
    std::copy(text.begin(), text.end(), base_ + page_);
    return {base_ + page_, text.size()};
  }

 private:
  std::size_t page_;
  std::size_t size_;
  char* base_;
};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == ',' || c == '\n' || c == '\r'; }
bool is_delimiter(char c) {
  return is_blank(c) || c == '[' || c == ']' || c == '{' || c == '}' || c == '#' || c == '"';
}

/// Checks all guarantees of NumberRun about the text that it has read.
template <class T>
bool keeps_promises(const NumberRun& run, std::string_view text, const T* out, std::size_t capacity) {
  const char* const begin = text.data();
  const char* const end = begin + text.size();
  if (run.next < begin || run.next > end || run.count > capacity) return false;
  std::size_t lines = 0;
  std::size_t count = 0;
  const char* line_start = nullptr;
  for (const char* p = begin; p < run.next;) {
    if (is_blank(*p)) {
      if (*p == '\r' && p + 1 < end && p[1] != '\n') return false;
      if (*p == '\n') {
        ++lines;
        line_start = p + 1;
      }
      ++p;
      continue;
    }
    const char* const token_end = std::find_if(p, end, is_delimiter);
    T value{};
    if (token_end > run.next || count >= run.count) return false;
    if (!parse_number({p, static_cast<std::size_t>(token_end - p)}, value)) return false;
    if (bits_of(value) != bits_of(out[count++])) return false;
    p = token_end;
  }
  return count == run.count && lines == run.lines && line_start == run.line_start;
}

/// Reads like the parser: in runs, and a single number if a run stops. Stops at invalid text. Starts with `window`
/// bytes, and continues when these are used up.
template <class T>
std::vector<T> read_all(const Path<T>& path, std::string_view text, std::size_t window, std::size_t capacity = 1000) {
  std::vector<T> values;
  std::vector<T> buffer(capacity);
  const char* p = text.data();
  const char* const last = p + text.size();
  const char* end = p + std::min(window, text.size());
  for (;;) {
    const NumberRun run = path.read(p, end, buffer.data(), capacity);
    REQUIRE(keeps_promises(run, {p, static_cast<std::size_t>(end - p)}, buffer.data(), capacity));
    values.insert(values.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(run.count));
    p = std::find_if_not(run.next, end, is_blank);
    const char* const token_end = std::find_if(p, end, is_delimiter);
    if (token_end == end && end != last) {
      end = last;
      continue;
    }
    T value{};
    if (!parse_number({p, static_cast<std::size_t>(token_end - p)}, value)) return values;
    values.push_back(value);
    p = token_end;
  }
}

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](T x, T y) { return bits_of(x) == bits_of(y); });
}

float reference(const std::string& token, float) { return std::strtof(token.c_str(), nullptr); }
std::int32_t reference(const std::string& token, std::int32_t) {
  const bool negative = token[0] == '-';
  const std::string plain = token.substr(negative || token[0] == '+');
  const int base = plain.starts_with("0x") ? 16 : 10;
  const long long magnitude = std::strtoll(plain.c_str(), nullptr, base);
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(negative ? -magnitude : magnitude));
}

template <class T, class Token>
void check_random_texts(unsigned seed, unsigned texts, unsigned numbers, Token token) {
  RandomBits random(seed);
  for (unsigned i = 0; i < texts; i += gs::watched_step(4)) {  // 4, not 3, because `shapes` depends on i % 3
    // Some texts have only one or few forms of numbers, because the paths handle groups of special numbers separately.
    const unsigned shapes = i % 3 == 0 ? 1 + below(random, 20) : numbers;
    std::vector<std::string> tokens;
    std::vector<T> expected;
    for (unsigned n = 0; n < numbers; ++n) {
      tokens.push_back(n < shapes ? token(random) : tokens[below(random, shapes)]);
      expected.push_back(reference(tokens.back(), T{}));
    }
    const std::string text = joined(random, tokens);
    for (const Path<T>& path : paths(T{})) {
      CAPTURE(path.name, seed, i);
      const std::vector<T> values = read_all(path, text, text.size());
      if (!same(values, expected)) {
        REQUIRE(values.size() == expected.size());
        for (std::size_t n = 0; n < values.size(); ++n) {
          INFO(tokens[n]);
          REQUIRE(bits_of(values[n]) == bits_of(expected[n]));
        }
      }
    }
  }
}

/// Tests every length of the text, with unreadable pages on both sides.
template <class T>
void check_prefixes(const std::string& text) {
  GuardedText guarded(text.size());
  std::vector<T> first(text.size() + 1);
  std::vector<T> out(text.size() + 1);
  for (std::size_t size = 0; size <= text.size(); ++size) {
    const std::string prefix = text.substr(0, size);
    for (const bool at_end : {true, false}) {
      const std::string_view view = at_end ? guarded.at_end(prefix) : guarded.at_start(prefix);
      const char* const begin = view.data();
      NumberRun expected{};
      for (const Path<T>& path : paths(T{})) {
        CAPTURE(path.name, size, at_end);
        const NumberRun run = path.read(begin, begin + size, out.data(), out.size());
        REQUIRE(keeps_promises(run, view, out.data(), out.size()));
        if (path.read == paths(T{}).front().read) {
          expected = run;
          first = out;
        }
        REQUIRE((run.next == expected.next));
        REQUIRE(run.count == expected.count);
        REQUIRE(run.lines == expected.lines);
        REQUIRE((run.line_start == expected.line_start));
        REQUIRE(std::equal(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(run.count), out.begin(),
                           [](T x, T y) { return bits_of(x) == bits_of(y); }));
      }
    }
  }
}

/// Splits the text into two windows at every position.
template <class T>
void check_splits(const std::string& text) {
  for (const Path<T>& path : paths(T{})) {
    const std::vector<T> whole = read_all(path, text, text.size());
    for (std::size_t window = 0; window <= text.size(); ++window) {
      CAPTURE(path.name, window);
      REQUIRE(same(read_all(path, text, window), whole));
    }
  }
}

template <class T>
void check_capacities(const std::string& text) {
  for (const Path<T>& path : paths(T{})) {
    const std::vector<T> whole = read_all(path, text, text.size());
    for (std::size_t capacity = 0; capacity < 40; ++capacity) {
      CAPTURE(path.name, capacity);
      std::vector<T> out(capacity + 20, T{77});
      const NumberRun run = path.read(text.data(), text.data() + text.size(), out.data(), capacity);
      REQUIRE(run.count == std::min(capacity, whole.size()));
      REQUIRE(keeps_promises(run, text, out.data(), capacity));
      REQUIRE(
          std::all_of(out.begin() + static_cast<std::ptrdiff_t>(capacity), out.end(), [](T x) { return x == T{77}; }));
    }
  }
}

template <class T>
void check_garbage(unsigned seed, const std::string& alphabet) {
  RandomBits random(seed);
  GuardedText guarded(400);
  std::vector<T> out(500);
  for (unsigned i = 0; i < 8000; i += gs::watched_step(3)) {
    std::string text;
    for (unsigned size = below(random, 400); text.size() < size;) {
      if (alphabet.empty()) {
        text += static_cast<char>(random());
      } else {
        text += alphabet[below(random, static_cast<unsigned>(alphabet.size()))];
      }
    }
    if (below(random, 2)) {  // invalid text after the numbers
      std::string numbers;
      for (unsigned n = below(random, 20); n > 0; --n) numbers += integer_token(random) + separator(random);
      text = (numbers + text).substr(0, 400);
    }
    const std::string_view view = guarded.at_end(text);
    for (const Path<T>& path : paths(T{})) {
      const NumberRun run = path.read(view.data(), view.data() + view.size(), out.data(), out.size());
      if (!keeps_promises(run, view, out.data(), out.size())) {
        CAPTURE(path.name, i, text);
        REQUIRE(keeps_promises(run, view, out.data(), out.size()));
      }
    }
  }
}

/// Checks numbers and end of the run on each path.
template <class T>
void check_stop(const std::string& text, std::size_t count, std::size_t next) {
  for (const Path<T>& path : paths(T{})) {
    CAPTURE(path.name, text);
    std::vector<T> out(200);
    const NumberRun run = path.read(text.data(), text.data() + text.size(), out.data(), out.size());
    CHECK(run.count == count);
    CHECK(run.next - text.data() == static_cast<std::ptrdiff_t>(next));
    CHECK(keeps_promises(run, text, out.data(), out.size()));
  }
}

TEST_CASE("parses numbers as VRML97 5.5 and 5.6 define") {
  float f = 0;
  CHECK((parse_number("-1.5e+3", f) && f == -1500.0f));
  CHECK((parse_number("+.5", f) && f == 0.5f));
  CHECK((parse_number("5.", f) && f == 5.0f));
  CHECK((parse_number("1e40", f) && std::isinf(f)));
  CHECK((parse_number("1e-60", f) && f == 0.0f));
  CHECK((parse_number("16777217", f) && f == 16777216.0f));
  CHECK((parse_number("9007199791611905", f) && f == std::strtof("9007199791611905", nullptr)));
  f = 7;
  for (const char* text :
       {"", "-", "+", ".", "-.", "+-1", "++1", "1e", "e5", "1.2.3", "nan", "inf", "-inf", "1 ", " 1"}) {
    INFO(text);
    CHECK_FALSE(parse_number(text, f));
  }
  CHECK(f == 7);
  double d = 0;
  CHECK((parse_number("0.1", d) && d == 0.1));
  std::int32_t i = 0;
  CHECK((parse_number("2147483647", i) && i == 2147483647));
  CHECK((parse_number("-2147483648", i) && i == std::numeric_limits<std::int32_t>::min()));
  CHECK((parse_number("0xFFFFFFFF", i) && i == -1));
  CHECK((parse_number("0x7f", i) && i == 127));
  i = 7;
  for (const char* text :
       {"", "-", "+", "2147483648", "-2147483649", "0x", "0x100000000", "1.0", "1e3", "--1", "+-1"}) {
    INFO(text);
    CHECK_FALSE(parse_number(text, i));
  }
  CHECK(i == 7);
}

TEST_CASE("rounds runs of floats correctly") { check_random_texts<float>(1, 300, 3000, float_token); }

TEST_CASE("rounds runs of the commonest floats correctly") {
  check_random_texts<float>(2, 100, 5000, [](RandomBits& random) {
    static const char* const patterns[] = {"%.6f", "%g", "%.3f", "%.8f", "%.0f", "%.1f"};
    return format(patterns[below(random, 6)], std::uniform_real_distribution<double>(-1e5, 1e5)(random));
  });
}

TEST_CASE("rounds runs of floats halfway between two floats to the even one") {
  check_random_texts<float>(3, 100, 2000, midpoint);
  check_random_texts<float>(4, 30, 2000, [](RandomBits& random) {
    return std::to_string(16777216 + (random() >> (12 + below(random, 28))) * 2 + 1);
  });
}

TEST_CASE("parses runs of integers exactly") { check_random_texts<std::int32_t>(5, 200, 3000, integer_token); }

TEST_CASE("parses the smallest and largest integers in runs") {
  const std::string eight = "2147483647 -2147483648 0 -0 +5 00000012 -99999999 99999999 ";
  const std::vector<std::int32_t> expected = {2147483647, -2147483647 - 1, 0, 0, 5, 12, -99999999, 99999999};
  for (const Path<std::int32_t>& path : paths(0)) {
    CAPTURE(path.name);
    std::vector<std::int32_t> out(40);
    const std::string text = eight + eight + eight + eight;
    const NumberRun run = path.read(text.data(), text.data() + text.size(), out.data(), out.size());
    REQUIRE(run.count == 32);
    for (std::size_t i = 0; i < run.count; ++i) CHECK(out[i] == expected[i % 8]);
  }
}

TEST_CASE("parses denormal floats, huge floats and negative zero in runs") {
  const std::string text = "1e-40 -1.17549435e-38 1.4e-45 7e-46 3.4028235e38 3.5e38 -0 -0.0 ";
  const std::string all = text + text + text;
  const float expected[] = {1e-40f, -1.17549435e-38f, 1.4e-45f, 0, 3.4028235e38f, INFINITY, -0.0f, -0.0f};
  for (const Path<float>& path : paths(0.0f)) {
    CAPTURE(path.name);
    std::vector<float> out(40);
    const NumberRun run = path.read(all.data(), all.data() + all.size(), out.data(), out.size());
    REQUIRE(run.count == 24);
    for (std::size_t i = 0; i < run.count; ++i) CHECK(bits_of(out[i]) == bits_of(expected[i % 8]));
  }
}

TEST_CASE("stops a run before the first token that is no number") {
  const std::string four = "1 -2.5, 3\n.25 ";
  const std::string ten = four + four + four + four + four + four + four + four + four + four;
  for (const std::string& text : {four, ten}) {
    const std::size_t count = text.size() / four.size() * 4;
    for (const char* rest : {"] 1 2 3 ", "# 1 2 3 ", "} 1 ", "1.2.3 4 ", "- 4 ", "+-1 4 ", ". 4 ", "-. 4 ", "1e 4 ",
                             "5e+ ", "1x 4 ", "1-2 4 ", "TRUE 1 ", "\r5 6 ", "\xff 1 ", "nan 1 ", "12} "}) {
      check_stop<float>(text + rest, count, text.size());
      check_stop<float>(text + rest + ten, count, text.size());
    }
    check_stop<float>(text + "8] 1", count + 1, text.size() + 1);
  }
  const std::string integers = "1 -2, 3\n4 5 6 7 8 9 -1 11 12 13 -14,15 16 17 18 19 20 ";
  for (const char* rest : {"0x10 1 ", "1.0 2 ", "1e3 2 ", "2147483648 1 ", "-2147483649 1 ", "- 1 ", "+-1 1 ", "1+ 2 ",
                           "99999999999999999999999 1 ", "] 1 ", "12abc 1 "}) {
    check_stop<std::int32_t>(integers + rest, 20, integers.size());
    check_stop<std::int32_t>(integers + rest + integers, 20, integers.size());
  }
}

TEST_CASE("parses each prefix of a text equally on every path, without reads beyond it") {
  RandomBits random(6);
  for (int i = 0; i < 6; ++i) {
    std::vector<std::string> floats;
    std::vector<std::string> integers;
    for (int n = 0; n < 60; ++n) {
      floats.push_back(i < 2 ? format("%.6f", std::uniform_real_distribution<double>(-9, 9)(random))
                             : float_token(random));
      integers.push_back(i < 2 ? std::to_string(below(random, 100000)) : integer_token(random));
    }
    check_prefixes<float>(joined(random, floats));
    check_prefixes<std::int32_t>(joined(random, integers));
  }
  check_prefixes<float>(std::string(300, '1') + " 2 3");
  check_prefixes<float>(std::string(300, ' ') + "\n2 3 4 5 6 7 8 9 10 11 12 " + std::string(200, '\n'));
  check_prefixes<std::int32_t>(std::string(70, '\n') + std::string(300, '7'));
}

TEST_CASE("parses a text in two windows like one text") {
  RandomBits random(7);
  std::vector<std::string> floats;
  std::vector<std::string> integers;
  for (int n = 0; n < 120; ++n) {
    floats.push_back(float_token(random));
    integers.push_back(integer_token(random));
  }
  check_splits<float>(joined(random, floats));
  check_splits<std::int32_t>(joined(random, integers));
}

TEST_CASE("writes at most the capacity of a run") {
  RandomBits random(8);
  std::string floats;
  std::string integers;
  for (int n = 0; n < 60; ++n) {
    floats += std::to_string(below(random, 1000)) + ".5" + (n % 3 ? " " : ",\n");
    integers += std::to_string(below(random, 100000)) + (n % 3 ? " " : ",\n");
  }
  check_capacities<float>(floats);
  check_capacities<std::int32_t>(integers);
}

TEST_CASE("stops a run at random bytes") {
  const std::string likely = "0123456789...--++eE ,\n\t\r] ";
  check_garbage<float>(9, "");
  check_garbage<std::int32_t>(10, "");
  check_garbage<float>(11, likely);
  check_garbage<std::int32_t>(12, likely);
  check_garbage<float>(13, "0123456789 .- ");
  check_garbage<std::int32_t>(14, "0123456789 - ");
}

}  // namespace

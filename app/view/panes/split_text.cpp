#include "app/view/panes/split_tree.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <string>
#include <utility>

// Text form of a split, for the command line and the saved settings.
namespace gs::app {
namespace {

constexpr std::string_view kSigns = "|/+";  // by SplitAxis
constexpr std::size_t kMaxSplitDepth = kMaxViewports;
constexpr double kMinWeight = 1e-3, kMaxWeight = 1e3;

std::string weight_text(double weight) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, ":%.5g", std::min(weight, kMaxWeight));
  return buffer;
}

void write(const SplitPart& part, std::string& text) {
  if (part.parts.empty()) {
    text += std::to_string(part.pane + 1);
    return;
  }
  double least = part.parts.front().weight;
  for (const SplitPart& one : part.parts) least = std::min(least, one.weight);
  for (const SplitPart& one : part.parts) {
    if (&one != &part.parts.front()) text += kSigns[static_cast<std::size_t>(part.axis)];
    if (!one.parts.empty()) text += '(';
    write(one, text);
    if (!one.parts.empty()) text += ')';
    if (one.weight / least > 1 + 1e-4) text += weight_text(one.weight / least);
  }
}

struct SplitReader {
  std::string_view rest;
  std::vector<std::size_t> panes;
  std::string problem;

  char next() const { return rest.empty() ? '\0' : rest.front(); }
  bool fail(std::string why) {
    if (problem.empty()) problem = std::move(why);
    return false;
  }
  bool weight(SplitPart& part) {
    if (next() != ':') return true;
    rest.remove_prefix(1);
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), part.weight);
    if (error != std::errc() || !(part.weight >= kMinWeight && part.weight <= kMaxWeight))
      return fail("expected a number from 0.001 to 1000 after ':'");
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    return true;
  }
  bool one(SplitPart& part, std::size_t depth) {
    if (next() == '(') {
      rest.remove_prefix(1);
      if (!parts(part, depth + 1)) return false;
      if (next() != ')') return fail("a bracket is not closed; expected ')'");
      rest.remove_prefix(1);
      return weight(part);
    }
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), part.pane);
    if (error != std::errc() || part.pane < 1 || part.pane > kMaxViewports)
      return fail("expected viewport numbers from 1 to " + std::to_string(kMaxViewports));
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    --part.pane;
    if (std::find(panes.begin(), panes.end(), part.pane) != panes.end())
      return fail("viewport " + std::to_string(part.pane + 1) + " is given twice");
    panes.push_back(part.pane);
    return weight(part);
  }
  bool parts(SplitPart& part, std::size_t depth) {
    if (depth > kMaxSplitDepth) return fail("too many nested brackets");
    std::vector<SplitPart> all(1);
    if (!one(all.back(), depth)) return false;
    const char sign = next();
    const std::size_t axis = sign == '\0' ? kSigns.npos : kSigns.find(sign);
    if (axis == kSigns.npos) {
      part = std::move(all.front());
      return true;
    }
    while (next() == sign) {
      rest.remove_prefix(1);
      if (!one(all.emplace_back(), depth)) return false;
    }
    if (next() != '\0' && kSigns.find(next()) != kSigns.npos)
      return fail("expected brackets around a mix of '|', '/' and '+'");
    part = {1, 0, static_cast<SplitAxis>(axis), std::move(all)};
    return true;
  }
};

}  // namespace

std::string split_text(const SplitTree& tree) {
  std::string text;
  write(tree.root, text);
  if (tree.maximised) text += '!' + std::to_string(*tree.maximised + 1);
  return text;
}

std::variant<SplitTree, std::string> read_split(std::string_view text) {
  SplitReader reader{text, {}, {}};
  SplitTree tree;
  if (!reader.parts(tree.root, 0)) return reader.problem;
  tree.root.weight = 1;
  if (reader.next() == '!') {
    reader.rest.remove_prefix(1);
    std::size_t pane = 0;
    const auto [end, error] = std::from_chars(reader.rest.data(), reader.rest.data() + reader.rest.size(), pane);
    if (error != std::errc() || pane < 1 || !has_pane(tree, pane - 1))
      return std::string("expected the number of one of the viewports after '!'");
    reader.rest.remove_prefix(static_cast<std::size_t>(end - reader.rest.data()));
    if (!tree.root.parts.empty()) tree.maximised = pane - 1;
  }
  if (!reader.rest.empty()) return "expected the end before '" + std::string(reader.rest.substr(0, 20)) + "'";
  return tree;
}

}  // namespace gs::app

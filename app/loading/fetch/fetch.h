#pragma once

#include "app/loading/fetch/content_handler.h"
#include "net/load/loader.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Reading of one resource from one of its candidate URLs.
struct Fetch {
  std::vector<net::Url> candidates;  // with fragments
  std::size_t next = 0;
  net::Origin from;        // of the text that contains the reference
  std::string given_path;  // path of a file as the user gave it
  int priority = 0;
  const vrml::Node* node = nullptr;  // the node that needs it; null if none or several do
  std::shared_ptr<ContentHandler> handler;
  std::uint64_t max_bytes = kNoLimit;  // bytes after this limit are omitted on purpose
  bool cut = false;                    // the limit omitted bytes

  // State of the current attempt.
  net::Validator validator;
  /// Requested part of the resource.
  enum class Part : std::uint8_t { all, front };
  Part part = Part::all;
  net::RequestId request;
  std::string first_problem;
  bool told = false;      // the problem was already reported for another fetch
  std::string reference;  // as the text writes it, for messages
  std::optional<net::MappedFile> file;
  std::vector<std::byte> data;  // of a data: URL
  std::span<const std::byte> rest;
  enum class Stage : std::uint8_t {
    seeking,    // no candidate has answered with the resource yet
    receiving,  // the handler receives its bytes
    refused,    // the handler has refused it
  };
  Stage stage = Stage::seeking;
  std::uint64_t received = 0;
  std::optional<std::uint64_t> total;
  std::uint64_t row = 0;  // in the LoadLedger

  static constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};
};

/// Order in which resources are read; the highest is first.
enum class Urgency : int { texture = 0, vectors = 1, inline_scene = 2, prototypes = 3, world = 4 };
/// Distance of the loader's priorities between two urgencies. The importance of a node adds less than one step.
inline constexpr int kUrgencyStep = 1000;
inline constexpr std::chrono::milliseconds kLongestWait{1000};  // max wait, so that limits are checked
/// Number of bytes of a long stream on a server that are read before views choose ranges.
inline constexpr std::uint64_t kFrontBytes = std::uint64_t{1} << 16;

}  // namespace gs::app

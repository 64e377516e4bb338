#pragma once

#include "app/loading/fetch/content_handler.h"
#include "net/load/loader.h"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Attempt to read one resource, candidate URL by candidate URL.
struct Fetch {
  std::vector<net::Url> candidates;  // URLs in the order of the attempts, with fragments
  std::size_t next = 0;
  std::size_t optional = 0;        // number of first candidates that may fail without a message
  std::vector<net::Url> together;  // all files to read at once, with the candidates; if empty, reads one by one
  net::Origin from;                // origin of the text that contains the reference
  std::string given_path;          // path of a file, spelled as by the user
  int priority = 0;
  bool refresh = false;              // asks the server even if the cache has the resource
  const vrml::Node* node = nullptr;  // node that refers to the resource; null for no node or several
  std::shared_ptr<ContentHandler> handler;
  std::uint64_t max_bytes = kNoLimit;  // maximum number of bytes; the others are omitted on purpose
  bool cut = false;                    // bytes beyond `max_bytes` were omitted

  // State of the current attempt.
  net::Validator validator;
  /// Requested part of the resource.
  enum class Part : std::uint8_t { all, front };
  Part part = Part::all;
  net::RequestId request;
  std::string first_problem;
  bool told = false;      // the diagnostics already have this problem, from another fetch
  std::string reference;  // reference as written in the text, for messages
  std::optional<net::MappedFile> file;
  std::vector<std::byte> data;  // bytes of a data: URL
  std::span<const std::byte> rest;
  enum class Stage : std::uint8_t {
    seeking,    // no candidate has answered yet
    receiving,  // the handler gets bytes
    refused,    // the handler has refused the resource
    refining,   // the resource has ended, and the handler reads finer versions
  };
  Stage stage = Stage::seeking;
  std::uint64_t received = 0;
  std::optional<std::uint64_t> total;
  std::shared_ptr<std::atomic<std::uint64_t>> parts;  // received bytes of parts; null if the file is read in order
  std::uint64_t row = 0;                              // row number in the LoadLedger

  static constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};
};

/// Order of reading. Resources with the highest value are read first.
enum class Urgency : int { texture = 0, vectors = 1, inline_scene = 2, prototypes = 3, world = 4 };
/// Difference of the loader's priority between two neighbouring values of Urgency. The importance of a node adds less.
inline constexpr int kUrgencyStep = 1000;
inline constexpr std::chrono::milliseconds kLongestWait{1000};  // max wait, after which limits are checked again
/// Number of first bytes of a long stream that are read before views choose ranges of it.
inline constexpr std::uint64_t kFrontBytes = std::uint64_t{1} << 16;

}  // namespace gs::app

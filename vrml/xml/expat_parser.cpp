#include "vrml/xml/expat_parser.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <utility>

namespace gs::vrml::xml {
namespace {

// Limits of the bytes that entities may expand to. Worlds use entities for short texts only.
constexpr float kMaxAmplification = 10;
constexpr unsigned long long kFreeExpansion = 1u << 20;  // bytes

// Budget share of the parser that runs on this thread. Expat's allocation functions take no argument for it.
thread_local Share* paying = nullptr;

struct Paying {
  explicit Paying(Share& share) : before(std::exchange(paying, &share)) {}
  ~Paying() { paying = before; }
  Paying(const Paying&) = delete;
  Paying& operator=(const Paying&) = delete;
  Share* before;
};

// A block of memory begins with its size.
constexpr std::size_t kHeader = alignof(std::max_align_t);

void* allocate(std::size_t size) {
  if (size > std::numeric_limits<std::size_t>::max() / 2 || !paying->grow(size + kHeader)) return nullptr;
  void* const block = std::malloc(size + kHeader);
  if (!block) return nullptr;
  *static_cast<std::size_t*>(block) = size;
  return static_cast<char*>(block) + kHeader;
}

void release(void* memory) {
  if (!memory) return;
  void* const block = static_cast<char*>(memory) - kHeader;
  paying->shrink_to(paying->amount() - std::min(paying->amount(), *static_cast<std::size_t*>(block) + kHeader));
  std::free(block);
}

void* reallocate(void* memory, std::size_t size) {
  if (!memory) return allocate(size);
  char* const block = static_cast<char*>(memory) - kHeader;
  const std::size_t before = *reinterpret_cast<std::size_t*>(block);
  if (size > std::numeric_limits<std::size_t>::max() / 2 || (size > before && !paying->grow(size - before)))
    return nullptr;
  void* const moved = std::realloc(block, size + kHeader);
  if (!moved) return nullptr;
  if (size < before) paying->shrink_to(paying->amount() - (before - size));
  *static_cast<std::size_t*>(moved) = size;
  return static_cast<char*>(moved) + kHeader;
}

}  // namespace

ExpatParser::ExpatParser(std::shared_ptr<Budget> budget, Handlers handlers)
    : memory_(std::move(budget), Resource::nodes), handlers_(std::move(handlers)) {
  static constexpr XML_Memory_Handling_Suite kMemory{allocate, reallocate, release};
  const Paying guard(memory_);
  parser_ = XML_ParserCreate_MM("UTF-8", &kMemory, nullptr);
  if (!parser_) return;
  XML_SetUserData(parser_, this);
  XML_SetElementHandler(parser_, begin_element, end_element);
  XML_SetCharacterDataHandler(parser_, take_text);
  XML_SetParamEntityParsing(parser_, XML_PARAM_ENTITY_PARSING_NEVER);
  XML_SetBillionLaughsAttackProtectionMaximumAmplification(parser_, kMaxAmplification);
  XML_SetBillionLaughsAttackProtectionActivationThreshold(parser_, kFreeExpansion);
}

ExpatParser::~ExpatParser() {
  const Paying guard(memory_);
  if (parser_) XML_ParserFree(parser_);
}

// Exceptions must not pass through the functions of Expat.
template <class Work>
void ExpatParser::guarded(Work&& work) noexcept {
  if (thrown_) return;
  try {
    work();
  } catch (...) {
    thrown_ = std::current_exception();
    stop();
  }
}

void ExpatParser::begin_element(void* user, const XML_Char* name, const XML_Char** attributes) {
  auto& self = *static_cast<ExpatParser*>(user);
  self.guarded([&] { self.handlers_.begin(name, attributes); });
}
void ExpatParser::end_element(void* user, const XML_Char*) {
  auto& self = *static_cast<ExpatParser*>(user);
  self.guarded([&] { self.handlers_.end(); });
}
void ExpatParser::take_text(void* user, const XML_Char* text, int length) {
  auto& self = *static_cast<ExpatParser*>(user);
  self.guarded([&] { self.handlers_.text({text, static_cast<std::size_t>(length)}); });
}

bool ExpatParser::parse(std::string_view text, bool last) {
  constexpr std::size_t kMaxPiece = 1u << 28;
  if (!parser_) return false;
  const Paying guard(memory_);
  for (;;) {
    const std::string_view piece = text.substr(0, kMaxPiece);
    text.remove_prefix(piece.size());
    const XML_Status status =
        XML_Parse(parser_, piece.data(), static_cast<int>(piece.size()), last && text.empty() ? XML_TRUE : XML_FALSE);
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
    if (status != XML_STATUS_OK) return false;
    if (text.empty()) return true;
  }
}

void ExpatParser::stop() { (void)XML_StopParser(parser_, XML_FALSE); }

bool ExpatParser::is_out_of_memory() const { return !parser_ || XML_GetErrorCode(parser_) == XML_ERROR_NO_MEMORY; }

std::string ExpatParser::error() const {
  const XML_LChar* const text = parser_ ? XML_ErrorString(XML_GetErrorCode(parser_)) : nullptr;
  return text ? text : "out of memory";
}

}  // namespace gs::vrml::xml

#include "app/script/bounds/bounded_natives.h"
#include "app/script/bounds/contained.h"

#include <js/Array.h>
#include <js/CallAndConstruct.h>
#include <js/Conversions.h>
#include <js/ErrorReport.h>
#include <js/Object.h>
#include <js/PropertyDescriptor.h>
#include <js/RegExp.h>
#include <js/String.h>
#include <js/Symbol.h>
#include <jsfriendapi.h>

#include <algorithm>
#include <iterator>

namespace gs::app::script {
namespace {

// Each limit keeps a call below about 0.3 s of processor time.
constexpr std::size_t kMaxComparisons = std::size_t{1} << 28;  // length of a text times length of the searched text
constexpr std::size_t kMaxPattern = std::size_t{1} << 14;      // max characters of a regular expression
constexpr std::size_t kMaxCased = std::size_t{1} << 22;        // max characters of a text to convert to another case
constexpr std::size_t kMaxNormalized = std::size_t{1} << 21, kMaxCollated = std::size_t{1} << 20;
constexpr std::size_t kMaxReordered = std::size_t{1} << 30;  // max sum of squared lengths of runs of combining marks
// Max characters of a pattern with the flag u, and with the flags u and i. The limits are low because Unicode sets are
// slow.
constexpr std::size_t kMaxUnicodePattern = 512, kMaxFoldedPattern = 96;
constexpr std::size_t kMaxJson = std::size_t{1} << 22, kMaxJsonParts = std::size_t{1} << 17;

const JSErrorFormatString* format_of(void* kind, const unsigned) {
  static constexpr JSErrorFormatString kRange{"BOUNDED", "{0}", 1, JSEXN_RANGEERR};
  static constexpr JSErrorFormatString kType{"BOUNDED", "{0}", 1, JSEXN_TYPEERR};
  return kind ? &kType : &kRange;
}

bool fail_type(JSContext* context, const std::string& why) {
  static int type_error = 0;
  JS_ReportErrorNumberUTF8(context, format_of, &type_error, 1, why.c_str());
  return false;
}

template <class Do>
auto with_characters(JSContext* context, JSLinearString* text, const Do& what) {
  const JS::AutoCheckCannotGC no_collection(context);
  const std::size_t length = JS::GetLinearStringLength(text);
  if (JS::LinearStringHasLatin1Chars(text)) return what(JS::GetLatin1LinearStringChars(no_collection, text), length);
  return what(JS::GetTwoByteLinearStringChars(no_collection, text), length);
}

// Reports whether normalization may move a character among its neighbours. East Asian blocks and all characters below
// U+0300 are never moved.
constexpr auto kMayBeMark = [](auto c) {
  return c >= 0x300 && !(c >= 0x3100 && c < 0xA66F) && !(c >= 0xAC00 && c < 0xD800);
};

/// Call of a bounded function. The check may replace arguments before the original is called.
struct Call {
  JSContext* context;
  JS::MutableHandleValue self;
  JS::RootedValueVector& arguments;

  // Converts a value to a string, as the original function would.
  [[nodiscard]] bool to_text(JS::MutableHandleValue value, std::size_t& length) const {
    JSString* const text = JS::ToString(context, value);
    if (!text) return false;
    value.setString(text);
    length = JS::GetStringLength(text);
    return true;
  }
  [[nodiscard]] bool argument_to_text(std::size_t index, std::size_t& length) const {
    length = 0;
    return index >= arguments.length() || to_text(arguments[index], length);
  }
  // Returns false for null and undefined, which have no text; the original function rejects them.
  [[nodiscard]] bool has_self() const { return !self.isNullOrUndefined(); }
};

bool check_search(JSContext* context, std::size_t text, std::size_t searched) {
  if (searched == 0 || text <= kMaxComparisons / searched) return true;
  return fail_range(context, "a search for " + std::to_string(searched) + " characters in " + std::to_string(text) +
                                 " takes too long; search a shorter string");
}

// Checks calls of indexOf and lastIndexOf.
bool bound_search(const Call& call) {
  std::size_t text = 0, searched = 0;
  if (!call.has_self()) return true;
  return call.to_text(call.self, text) && call.argument_to_text(0, searched) &&
         check_search(call.context, text, searched);
}

// Checks calls of Array's indexOf, lastIndexOf and includes. Each comparison with a long string takes long.
bool bound_element_search(const Call& call) {
  if (!call.self.isObject() || call.arguments.length() == 0 || !call.arguments[0].isString()) return true;
  const std::size_t searched = JS::GetStringLength(call.arguments[0].toString());
  JS::RootedObject array(call.context, &call.self.toObject());
  std::uint32_t length = 0;
  bool is_array = false;
  if (searched < 64 || !JS::IsArrayObject(call.context, array, &is_array)) return searched < 64;
  return !is_array ||
         (JS::GetArrayLength(call.context, array, &length) && check_search(call.context, length, searched));
}

bool is_pattern(JSContext* context, JS::HandleObject object, bool& result) {
  JS::RootedId id(context, JS::GetWellKnownSymbolKey(context, JS::SymbolCode::match));
  JS::RootedValue match(context);
  if (!JS_GetPropertyById(context, object, id, &match)) return false;
  if (!match.isUndefined()) return result = JS::ToBoolean(match), true;
  return JS::ObjectIsRegExp(context, object, &result);
}

bool bound_includes(const Call& call) {
  if (call.has_self() && call.arguments.length() > 0 && call.arguments[0].isObject()) {
    JS::RootedObject object(call.context, &call.arguments[0].toObject());
    bool pattern = false;
    if (!is_pattern(call.context, object, pattern)) return false;
    if (pattern) return fail_type(call.context, "String.prototype.includes does not accept a regular expression");
  }
  return bound_search(call);
}

// Rejects long runs of combining characters, because SpiderMonkey reorders a run in quadratic time.
bool check_marks(JSContext* context, JS::HandleValue value) {
  JSLinearString* const text = JS_EnsureLinearString(context, value.toString());
  if (!text) return false;
  const std::size_t work = with_characters(context, text, [](const auto* characters, std::size_t count) {
    std::size_t run = 0, sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
      run = kMayBeMark(characters[i]) ? run + 1 : 0;
      sum += run;  // a run of n characters adds about n * n / 2
    }
    return sum;
  });
  return work <= kMaxReordered / 2 || fail_range(context, "a string has too many consecutive combining characters");
}

bool bound_normalize(const Call& call) {
  std::size_t length = 0;
  if (!call.has_self()) return true;
  if (!call.to_text(call.self, length)) return false;
  if (length > kMaxNormalized) return too_long(call.context, "a text to normalize", length, kMaxNormalized);
  return check_marks(call.context, call.self);
}

bool bound_compare(const Call& call) {
  if (!call.has_self()) return true;
  std::size_t length = 0;
  if (!call.to_text(call.self, length)) return false;
  if (call.arguments.length() > 0) {
    std::size_t other = 0;
    if (!call.argument_to_text(0, other)) return false;
    length = std::max(length, other);
  }
  if (length > kMaxCollated) return too_long(call.context, "a text to compare", length, kMaxCollated);
  return check_marks(call.context, call.self) &&
         (call.arguments.length() == 0 || check_marks(call.context, call.arguments[0]));
}

bool bound_json(const Call& call) {
  std::size_t length = 0;
  if (call.arguments.length() == 0) return true;
  if (!call.argument_to_text(0, length)) return false;
  if (length > kMaxJson) return too_long(call.context, "a text of JSON", length, kMaxJson);
  JSLinearString* const text = JS_EnsureLinearString(call.context, call.arguments[0].toString());
  if (!text) return false;
  return with_characters(
             call.context, text,
             [&](const auto* characters, std::size_t count) {
               const auto parts = static_cast<std::size_t>(std::count_if(
                   characters, characters + count, [](auto c) { return c == '[' || c == '{' || c == ':'; }));
               return parts <= kMaxJsonParts && longest_number(characters, count) <= kMaxDigits;
             }) ||
         fail_range(call.context, "a JSON text has too many parts or digits for a Script");
}

// Checks calls of toLowerCase, toUpperCase and their locale variants.
bool bound_case(const Call& call) {
  std::size_t length = 0;
  if (!call.has_self()) return true;
  if (!call.to_text(call.self, length)) return false;
  return length <= kMaxCased || too_long(call.context, "a text", length, kMaxCased);
}

bool check_pattern(JSContext* context, std::size_t length) {
  return length <= kMaxPattern || too_long(context, "a regular expression", length, kMaxPattern);
}

// Checks the pattern of RegExp() and compile(). Accepts RegExp objects, which are already compiled. Converts other
// values to text first.
bool bound_pattern(const Call& call) {
  std::size_t length = 0;
  if (call.arguments.length() == 0 || call.arguments[0].isUndefined()) return true;
  if (call.arguments[0].isObject()) {
    JS::RootedObject object(call.context, &call.arguments[0].toObject());
    bool is_compiled = false, pattern = false;
    if (!JS::ObjectIsRegExp(call.context, object, &is_compiled)) return false;
    if (is_compiled) return true;
    if (!is_pattern(call.context, object, pattern)) return false;
    if (pattern) {
      if (call.arguments.length() < 2 && !call.arguments.append(JS::UndefinedValue())) return false;
      if (!JS_GetProperty(call.context, object, "source", call.arguments[0])) return false;
      if (call.arguments[1].isUndefined() && !JS_GetProperty(call.context, object, "flags", call.arguments[1]))
        return false;
    }
  }
  return call.argument_to_text(0, length) && check_pattern(call.context, length);
}

// Reports whether the pattern is literal text. SpiderMonkey cannot be interrupted during a search for literal text.
bool is_plain(JSLinearString* pattern, JSContext* context) {
  return with_characters(context, pattern, [](const auto* characters, std::size_t count) {
    return std::none_of(characters, characters + count, [](auto c) {
      return c < 128 && std::string_view("^$.*+?()[]{}|").find(static_cast<char>(c)) != std::string_view::npos;
    });
  });
}

bool bound_exec(const Call& call) {
  bool is_compiled = false;
  if (!call.self.isObject()) return true;
  JS::RootedObject object(call.context, &call.self.toObject());
  if (!JS::ObjectIsRegExp(call.context, object, &is_compiled)) return false;
  // Reject objects that imitate a RegExp. The original function would read their pattern again after this check, and
  // could get another one.
  if (!is_compiled) return fail_type(call.context, "called on an object that is not a RegExp");
  std::size_t length = 0;
  if (!call.argument_to_text(0, length)) return false;
  JS::RootedString pattern(call.context, JS::GetRegExpSource(call.context, object));
  if (!pattern) return false;
  const std::size_t searched = JS::GetStringLength(pattern);
  const JS::RegExpFlags flags = JS::GetRegExpFlags(call.context, object);
  const std::size_t most = !flags.unicode() ? kMaxPattern : flags.ignoreCase() ? kMaxFoldedPattern : kMaxUnicodePattern;
  if (searched > most) return too_long(call.context, "a regular expression", searched, most);
  if (length <= kMaxComparisons / std::max<std::size_t>(1, searched)) return true;
  JSLinearString* const linear = JS_EnsureLinearString(call.context, pattern);
  return linear && (!is_plain(linear, call.context) || check_search(call.context, length, searched));
}

// ---- Functions that call a method of their argument, such as its Symbol.replace method

enum class Outcome : std::uint8_t { failed, called, goes_on };

// Calls the method of the argument that `symbol` names. Returns goes_on if the argument has no such method.
Outcome call_own(const Call& call, JS::SymbolCode symbol, bool needs_global_flag, JS::MutableHandleValue result) {
  if (!call.has_self() || call.arguments.length() == 0 || !call.arguments[0].isObject()) return Outcome::goes_on;
  JSContext* const context = call.context;
  JS::RootedObject object(context, &call.arguments[0].toObject());
  if (needs_global_flag) {
    bool pattern = false;
    JS::RootedValue flags(context);
    if (!is_pattern(context, object, pattern)) return Outcome::failed;
    if (pattern) {
      if (!JS_GetProperty(context, object, "flags", &flags)) return Outcome::failed;
      JS::RootedString text(context, JS::ToString(context, flags));
      JSLinearString* const linear = text ? JS_EnsureLinearString(context, text) : nullptr;
      if (!linear) return Outcome::failed;
      const bool global = with_characters(context, linear, [](const auto* characters, std::size_t count) {
        return std::find(characters, characters + count, 'g') != characters + count;
      });
      if (!global) {
        (void)fail_type(context, "expected a regular expression with the flag g");
        return Outcome::failed;
      }
    }
  }
  JS::RootedId id(context, JS::GetWellKnownSymbolKey(context, symbol));
  JS::RootedValue method(context);
  if (!JS_GetPropertyById(context, object, id, &method)) return Outcome::failed;
  if (method.isNullOrUndefined()) return Outcome::goes_on;
  JS::RootedValueVector arguments(context);
  if (!arguments.append(call.self)) return Outcome::failed;
  for (std::size_t i = 1; i < call.arguments.length(); ++i)
    if (!arguments.append(call.arguments[i])) return Outcome::failed;
  return JS::Call(context, object, method, arguments, result) ? Outcome::called : Outcome::failed;
}

// Checks calls of match, matchAll and search. They make a regular expression of a text argument.
bool bound_match(const Call& call) {
  std::size_t text = 0, pattern = 0;
  if (!call.has_self() || call.arguments.length() == 0 || call.arguments[0].isUndefined()) return true;
  return call.to_text(call.self, text) && call.argument_to_text(0, pattern) && check_pattern(call.context, pattern) &&
         check_search(call.context, text, pattern);
}

constexpr JS::SymbolCode kNone = JS::SymbolCode::Limit;

/// Row of the table of functions that are replaced by bounded ones.
struct Bounded {
  JSProtoKey of;  // prototype that has the function; if `is_static`, the constructor or namespace object
  const char* name;
  bool (*check)(const Call&);
  JS::SymbolCode symbol = kNone;  // method of the argument to which the function delegates
  bool needs_global_flag = false, is_static = false;
  JS::SymbolCode key = kNone;  // symbol of the property, if it has no name
};
constexpr Bounded kBounded[] = {
    {JSProto_String, "indexOf", bound_search},
    {JSProto_String, "lastIndexOf", bound_search},
    {JSProto_String, "includes", bound_includes},
    {JSProto_String, "split", bound_search, JS::SymbolCode::split},
    {JSProto_String, "replace", bound_search, JS::SymbolCode::replace},
    {JSProto_String, "replaceAll", bound_search, JS::SymbolCode::replace, true},
    {JSProto_String, "match", bound_match, JS::SymbolCode::match},
    {JSProto_String, "matchAll", bound_match, JS::SymbolCode::matchAll, true},
    {JSProto_String, "search", bound_match, JS::SymbolCode::search},
    {JSProto_Array, "indexOf", bound_element_search},
    {JSProto_Array, "lastIndexOf", bound_element_search},
    {JSProto_Array, "includes", bound_element_search},
    {JSProto_String, "normalize", bound_normalize},
    {JSProto_String, "localeCompare", bound_compare},
    {JSProto_String, "toLowerCase", bound_case},
    {JSProto_String, "toUpperCase", bound_case},
    {JSProto_String, "toLocaleLowerCase", bound_case},
    {JSProto_String, "toLocaleUpperCase", bound_case},
    {JSProto_RegExp, "exec", bound_exec},
    {JSProto_RegExp, "test", bound_exec},
    {JSProto_RegExp, "[Symbol.match]", bound_exec, kNone, false, false, JS::SymbolCode::match},
    {JSProto_RegExp, "[Symbol.matchAll]", bound_exec, kNone, false, false, JS::SymbolCode::matchAll},
    {JSProto_RegExp, "[Symbol.replace]", bound_exec, kNone, false, false, JS::SymbolCode::replace},
    {JSProto_RegExp, "[Symbol.search]", bound_exec, kNone, false, false, JS::SymbolCode::search},
    {JSProto_RegExp, "[Symbol.split]", bound_exec, kNone, false, false, JS::SymbolCode::split},
    {JSProto_RegExp, "compile", bound_pattern},
    {JSProto_JSON, "parse", bound_json, kNone, false, true},
};

constexpr std::size_t kOriginalSlot = 0, kIndexSlot = 1;

bool call_bounded(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  JS::RootedObject callee(context, &args.callee());
  const Bounded& bounded = kBounded[js::GetFunctionNativeReserved(callee, kIndexSlot).toInt32()];
  JS::RootedValue original(context, js::GetFunctionNativeReserved(callee, kOriginalSlot));
  JS::RootedValue self(context, args.thisv());
  JS::RootedValueVector arguments(context);
  if (!arguments.append(args.array(), args.length())) return false;
  const Call call{context, &self, arguments};
  if (bounded.symbol != kNone) {
    const Outcome outcome = call_own(call, bounded.symbol, bounded.needs_global_flag, args.rval());
    if (outcome != Outcome::goes_on) return outcome == Outcome::called;
  }
  return bounded.check(call) && JS::Call(context, self, original, arguments, args.rval());
}

bool same_constructor(JSContext* context, JS::HandleObject pattern, JS::HandleObject callee, bool& same) {
  JS::RootedValue constructor(context);
  if (!JS_GetProperty(context, pattern, "constructor", &constructor)) return false;
  same = constructor.isObject() && &constructor.toObject() == callee;
  return true;
}

// Implements RegExp() and new RegExp().
bool construct_pattern(JSContext* context, unsigned argc, JS::Value* vp) {
  const JS::CallArgs args = JS::CallArgsFromVp(argc, vp);
  JS::RootedObject callee(context, &args.callee());
  // Without `new`, a RegExp argument is returned unchanged.
  if (!args.isConstructing() && args.get(0).isObject() && args.get(1).isUndefined()) {
    JS::RootedObject object(context, &args[0].toObject());
    bool pattern = false, same = false;
    if (!is_pattern(context, object, pattern) || (pattern && !same_constructor(context, object, callee, same)))
      return false;
    if (same) {
      args.rval().setObject(*object);
      return true;
    }
  }
  JS::RootedValue original(context, js::GetFunctionNativeReserved(callee, kOriginalSlot));
  JS::RootedValue self(context);
  JS::RootedValueVector arguments(context);
  if (!arguments.append(args.array(), args.length()) || !bound_pattern({context, &self, arguments})) return false;
  JS::RootedObject target(context, args.isConstructing() ? &args.newTarget().toObject() : &original.toObject());
  JS::RootedObject made(context);
  if (!JS::Construct(context, original, target, arguments, &made)) return false;
  args.rval().setObject(*made);
  return true;
}

JSObject* replacement(JSContext* context, JSNative native, JS::HandleValue original, unsigned flags, const char* name) {
  std::uint16_t length = 0;
  JS::RootedObject before(context, original.isObject() ? &original.toObject() : nullptr);
  JS::RootedFunction function(context, before ? JS_GetObjectFunction(before) : nullptr);
  if (!function || !JS_GetFunctionLength(context, function, &length)) return nullptr;
  JSFunction* const made = js::NewFunctionWithReserved(context, native, length, flags, name);
  JSObject* const object = made ? JS_GetFunctionObject(made) : nullptr;
  if (object) js::SetFunctionNativeReserved(object, kOriginalSlot, original);
  return object;
}

// Replaces the global RegExp by a bounded constructor with the same static properties.
bool bound_constructor(JSContext* context, JS::HandleObject global) {
  JS::RootedObject prototype(context), before(context);
  JS::RootedValue original(context);
  if (!JS_GetClassPrototype(context, JSProto_RegExp, &prototype) ||
      !JS_GetProperty(context, prototype, "constructor", &original))
    return false;
  before = original.isObject() ? &original.toObject() : nullptr;
  JS::RootedObject made(context,
                        replacement(context, contained<construct_pattern>, original, JSFUN_CONSTRUCTOR, "RegExp"));
  if (!made || !JS_LinkConstructorAndPrototype(context, made, prototype)) return false;
  JS::RootedIdVector names(context);
  if (!js::GetPropertyKeys(context, before, JSITER_OWNONLY | JSITER_HIDDEN | JSITER_SYMBOLS, &names)) return false;
  for (std::size_t i = 0; i < names.length(); ++i) {
    JS::RootedId name(context, names[i]);
    bool has = false;
    if (!JS_HasOwnPropertyById(context, made, name, &has)) return false;
    if (has) continue;
    JS::Rooted<mozilla::Maybe<JS::PropertyDescriptor>> property(context);
    if (!JS_GetOwnPropertyDescriptorById(context, before, name, &property)) return false;
    if (property.isNothing()) continue;
    JS::Rooted<JS::PropertyDescriptor> value(context, *property);
    if (!JS_DefinePropertyById(context, made, name, value)) return false;
  }
  return JS_DefineProperty(context, global, "RegExp", made, 0);
}

}  // namespace

bool bound_natives(JSContext* context, JS::HandleObject global) {
  for (std::size_t i = 0; i < std::size(kBounded); ++i) {
    const Bounded& bounded = kBounded[i];
    JS::RootedObject holder(context);
    if (!(bounded.is_static ? JS_GetClassObject(context, bounded.of, &holder)
                            : JS_GetClassPrototype(context, bounded.of, &holder)))
      return false;
    JS::RootedValue original(context);
    JS::RootedString name(context, JS_AtomizeString(context, bounded.name));
    JS::RootedId id(context);
    if (bounded.key != kNone)
      id = JS::GetWellKnownSymbolKey(context, bounded.key);
    else if (!name || !JS_StringToId(context, name, &id))
      return false;
    if (!JS_GetPropertyById(context, holder, id, &original)) return false;
    JS::RootedObject made(context, replacement(context, contained<call_bounded>, original, 0, bounded.name));
    if (!made) return false;
    js::SetFunctionNativeReserved(made, kIndexSlot, JS::Int32Value(static_cast<std::int32_t>(i)));
    if (!JS_DefinePropertyById(context, holder, id, made, 0)) return false;
  }
  return bound_constructor(context, global);
}

bool fail_range(JSContext* context, const std::string& why) {
  JS_ReportErrorNumberUTF8(context, format_of, nullptr, 1, why.c_str());
  return false;
}

bool too_long(JSContext* context, const char* what, std::size_t length, std::size_t most) {
  return fail_range(context, std::string(what) + " has " + std::to_string(length) + " characters; the limit is " +
                                 std::to_string(most));
}

}  // namespace gs::app::script

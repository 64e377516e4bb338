#include "app/script/bounds/bounded_natives.h"
#include "app/script/bounds/field_memory.h"
#include "app/script/natives.h"
#include "app/script/script_world.h"
#include "vrml/scene/values/field_numbers.h"

#include <js/Array.h>
#include <js/CharacterEncoding.h>
#include <js/Conversions.h>
#include <js/Object.h>
#include <js/Wrapper.h>
#include <jsfriendapi.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

// Conversions between field values and values of programs (VRML97 C.6.2).
namespace gs::app::script {
namespace {

using vrml::FieldType;
using vrml::FieldValue;

constexpr std::size_t kMaxListText = std::size_t{32} << 20;  // max bytes of all texts of a new list

bool is_true(JSContext* context, JS::HandleValue value) {
  // An object made by `new SFBool(FALSE)` is false.
  if (value.isObject()) {
    JS::RootedObject object(context, &value.toObject());
    js::ESClass of = js::ESClass::Other;
    JS::RootedValue primitive(context);
    if (JS::GetBuiltinClass(context, object, &of) && of == js::ESClass::Boolean &&
        JS::ToPrimitive(context, object, JSTYPE_NUMBER, &primitive))
      return JS::ToBoolean(primitive);
  }
  return JS::ToBoolean(value);
}

bool to_number(JSContext* context, JS::HandleValue value, double& number) {
  if (value.isNullOrUndefined()) return fail(context, "expected a number");
  return JS::ToNumber(context, value, &number);
}

bool to_float(JSContext* context, JS::HandleValue value, float& number) {
  double wide = 0;
  if (!to_number(context, value, wide)) return false;
  number = static_cast<float>(wide);
  return true;
}

bool to_int(JSContext* context, JS::HandleValue value, std::int32_t& number) {
  double wide = 0;
  if (value.isBoolean()) return number = value.toBoolean() ? 1 : 0, true;
  if (!to_number(context, value, wide)) return false;
  if (!std::isfinite(wide)) wide = 0;
  // Accept unsigned 32-bit numbers, because pixels of images may exceed the largest signed number.
  number = wide >= -2147483648.0 && wide < 4294967296.0 ? static_cast<std::int32_t>(static_cast<std::int64_t>(wide))
                                                        : JS::ToInt32(wide);
  return true;
}

// Converts a value to the components of a tuple. `nested` means that the value is the first element of a list or array;
// further nesting is rejected.
bool tuple_components(JSContext* context, JS::HandleValue value, FieldType type, double* components,
                      bool nested = false) {
  const int count = vrml::number_count(type);
  FieldType found{};
  if (value.isObject()) {
    JS::RootedObject object(context, &value.toObject());
    if (is_tuple(object, found, components)) {
      if (found == type ||
          (vrml::number_count(found) == count && type != FieldType::SFRotation && found != FieldType::SFRotation))
        return true;
    } else {
      bool is_array = false;
      if (!JS::IsArrayObject(context, object, &is_array)) return false;
      const ListBox* const list = list_of(object);
      // Accept a list that contains a tuple, or an array of numbers.
      if (list || is_array) {
        JS::RootedValue element(context);
        if (!JS_GetElement(context, object, 0, &element)) return false;
        if (element.isObject() && !nested) return tuple_components(context, element, type, components, true);
        for (int i = 0; i < count; ++i) {
          if (!JS_GetElement(context, object, static_cast<std::uint32_t>(i), &element)) return false;
          if (!to_number(context, element, components[i])) return false;
        }
        return true;
      }
    }
  }
  return fail(context, "expected an " + std::string(vrml::name_of(type)));
}

// Converts a value to a node. `nested` means that the value is the first element of a list or array; further nesting is
// rejected.
bool to_node(JSContext* context, JS::HandleValue value, std::uint64_t scene, vrml::NodeId& node, bool nested = false) {
  node = {};
  if (value.isNullOrUndefined()) return true;
  if (value.isObject()) {
    JS::RootedObject object(context, &value.toObject());
    if (const NodeBox* box = node_of(object)) {
      if (!box->lives()) return true;
      if (box->node.scene != scene) return fail(context, "the node belongs to another file");
      node = box->node.id;
      return true;
    }
    bool is_array = false;
    if (!JS::IsArrayObject(context, object, &is_array)) return false;
    if (!nested && (is_array || list_of(object))) {
      JS::RootedValue element(context);
      return JS_GetElement(context, object, 0, &element) && to_node(context, element, scene, node, true);
    }
  }
  if (value.isFalse() || (value.isInt32() && value.toInt32() == 0)) return true;
  return fail(context, "expected a node");
}

template <class T>
bool to_element(JSContext* context, JS::HandleValue value, FieldType type, std::uint64_t scene, T& element) {
  FieldValue field;
  if (!to_field(context, value, type, scene, field)) return false;
  element = vrml::element_in(*std::get_if<vrml::SingleValue<T>>(&field));
  return true;
}

template <class T>
bool to_elements(JSContext* context, JS::HandleValue value, FieldType type, std::uint64_t scene, Array<T>& array) {
  array.clear();
  if (value.isNullOrUndefined()) return true;
  if (value.isObject()) {
    JS::RootedObject object(context, &value.toObject());
    if (ListBox* box = list_of(object)) {
      FieldValue* const own = list_value(*box);
      if (const auto* same = own ? std::get_if<Array<T>>(own) : nullptr) {
        if constexpr (std::is_same_v<T, vrml::NodeId>)
          if (!same->empty() && (!box->link->lives(box->scene) || box->scene != scene))
            return fail(context, "the nodes belong to another file");
        array = *same;
        return true;
      }
    }
    bool is_array = false;
    if (!JS::IsArrayObject(context, object, &is_array)) return false;
    if (is_array || list_of(object)) {
      JS::RootedValue length(context), element(context);
      double count = 0;
      [[maybe_unused]] std::size_t text = 0;
      if (!JS_GetProperty(context, object, "length", &length) || !JS::ToNumber(context, length, &count)) return false;
      if (!world_of(context).engine().may_have(static_cast<std::size_t>(count) * sizeof(T)))
        return fail(context, "too many elements for the memory limit of programs");
      for (std::uint32_t i = 0; i < count; ++i) {
        T one{};
        if (!JS_GetElement(context, object, i, &element)) return false;
        if (!element.isUndefined() && !to_element(context, element, type, scene, one)) return false;
        if constexpr (std::is_same_v<T, vrml::SFString>) {
          text += one.view().size();
          if (text > kMaxListText || !world_of(context).engine().may_have(text))
            return fail_range(context, "the strings of a list exceed the limit of a Script");
        }
        array.push_back(std::move(one));
        if (i % 4096 == 4095 && !JS_CheckForInterrupt(context)) return false;
      }
      return true;
    }
  }
  T one{};
  if (!to_element(context, value, type, scene, one)) return false;
  array.push_back(std::move(one));
  return true;
}

// Converts a value to the numbers of a matrix: a matrix of this size, or a list or array of numbers.
bool matrix_numbers(JSContext* context, JS::HandleValue value, FieldType type, double* numbers) {
  const int count = vrml::number_count(type);
  if (value.isObject()) {
    JS::RootedObject object(context, &value.toObject());
    if (numbers_of_matrix(object, count, numbers)) return true;
    bool is_array = false;
    if (!JS::IsArrayObject(context, object, &is_array)) return false;
    if (is_array || list_of(object)) {
      JS::RootedValue element(context);
      for (int i = 0; i < count; ++i)
        if (!JS_GetElement(context, object, static_cast<std::uint32_t>(i), &element) ||
            !to_number(context, element, numbers[i]))
          return false;
      return true;
    }
  }
  return fail(context, "expected an " + std::string(vrml::name_of(type)));
}

}  // namespace

bool fail(JSContext* context, const std::string& why) {
  JS_ReportErrorUTF8(context, "%s", why.c_str());
  return false;
}

bool make_string(JSContext* context, std::string_view text, JS::MutableHandleValue value) {
  JSString* made = JS_NewStringCopyUTF8N(context, JS::UTF8Chars(text.data(), text.size()));
  if (!made) {
    // The text is not UTF-8.
    if (JS_IsExceptionPending(context)) JS_ClearPendingException(context);
    made = JS_NewStringCopyN(context, text.data(), text.size());
    if (!made) return false;
  }
  value.setString(made);
  return true;
}

bool text_of_value(JSContext* context, JS::HandleValue value, std::string& text) {
  JS::RootedString string(context, JS::ToString(context, value));
  if (!string) return false;
  if (const std::size_t length = JS::GetStringLength(string); length > kMaxCharacters)
    return fail_range(context, "a string of " + std::to_string(length) + " characters; the limit is " +
                                   std::to_string(kMaxCharacters));
  const JS::UniqueChars bytes = JS_EncodeStringToUTF8(context, string);
  if (!bytes) return false;
  text = bytes.get();
  return true;
}

bool cut_text_of_value(JSContext* context, JS::HandleValue value, std::size_t most, std::string& text) {
  JS::RootedString string(context, JS::ToString(context, value));
  if (string && JS::GetStringLength(string) > most) string = JS_NewDependentString(context, string, 0, most);
  if (!string) return false;
  const JS::RootedValue cut(context, JS::StringValue(string));
  return text_of_value(context, cut, text);
}

bool to_value(JSContext* context, std::uint64_t scene, const FieldValue& field, Source source,
              JS::MutableHandleValue value) {
  switch (vrml::type_of(field)) {
    case FieldType::SFBool:
      value.setBoolean(std::get<vrml::SFBool>(field));
      return true;
    case FieldType::SFInt32:
      value.setInt32(std::get<vrml::SFInt32>(field));
      return true;
    case FieldType::SFFloat:
      value.set(JS::NumberValue(std::get<vrml::SFFloat>(field)));
      return true;
    case FieldType::SFTime:
      value.set(JS::NumberValue(std::get<vrml::SFTime>(field)));
      return true;
    case FieldType::SFString:
      return make_string(context, std::get<vrml::SFString>(field).view(), value);
    case FieldType::SFDouble:
      value.set(JS::NumberValue(std::get<vrml::SFDouble>(field).value));
      return true;
    case FieldType::SFNode:
      return node_to_value(context, {scene, std::get<vrml::SFNode>(field)}, value);
    case FieldType::SFImage: {
      JSObject* const image = make_image(context, std::get<vrml::SFImage>(field), source);
      value.setObjectOrNull(image);
      return image != nullptr;
    }
    default:
      break;
  }
  JSObject* made = nullptr;
  if (const int count = vrml::number_count(vrml::type_of(field)); !vrml::is_multiple(vrml::type_of(field))) {
    double numbers[vrml::kMaxNumbers] = {};
    vrml::read_numbers(field, numbers);
    made = count > kMaxComponents ? make_matrix(context, vrml::type_of(field), numbers, source)
                                  : make_tuple(context, vrml::type_of(field), numbers, source);
  } else {
    ListBox box;
    box.scene = scene;
    box.value = field;
    made = make_list(context, std::move(box), source);
  }
  value.setObjectOrNull(made);
  return made != nullptr;
}

bool to_field(JSContext* context, JS::HandleValue value, FieldType type, std::uint64_t scene, FieldValue& field) {
  switch (type) {
    case FieldType::SFBool:
      field = is_true(context, value);
      return true;
    case FieldType::SFInt32: {
      std::int32_t number = 0;
      if (!to_int(context, value, number)) return false;
      field = number;
      return true;
    }
    case FieldType::SFFloat: {
      float number = 0;
      if (!to_float(context, value, number)) return false;
      field = number;
      return true;
    }
    case FieldType::SFTime: {
      double number = 0;
      if (!to_number(context, value, number)) return false;
      field = number;
      return true;
    }
    case FieldType::SFString: {
      std::string text;
      if (value.isObject() && list_of(&value.toObject())) {
        JS::RootedObject list(context, &value.toObject());
        JS::RootedValue element(context);
        if (!JS_GetElement(context, list, 0, &element)) return false;
        if (!element.isUndefined() && !text_of_value(context, element, text)) return false;
      } else if (!text_of_value(context, value, text)) {
        return false;
      }
      field = vrml::SFString(text);
      return true;
    }
    case FieldType::SFDouble: {
      double number = 0;
      if (!to_number(context, value, number)) return false;
      field = vrml::SFDouble{number};
      return true;
    }
    case FieldType::SFNode: {
      vrml::NodeId node;
      if (!to_node(context, value, scene, node)) return false;
      field = node;
      return true;
    }
    case FieldType::SFImage: {
      vrml::PixelImage image;
      if (!value.isObject() || !is_image(&value.toObject())) return fail(context, "expected an SFImage");
      JS::RootedObject object(context, &value.toObject());
      if (!image_of(context, object, image)) return false;
      field = std::move(image);
      return true;
    }
    default:
      break;
  }
  field = vrml::initial_value(type);
  if (!vrml::is_multiple(type)) {
    double numbers[vrml::kMaxNumbers] = {};
    if (!(vrml::number_count(type) > kMaxComponents ? matrix_numbers(context, value, type, numbers)
                                                    : tuple_components(context, value, type, numbers)))
      return false;
    vrml::write_numbers(field, numbers);
    return true;
  }
  return std::visit(
      [&](auto& array) {
        if constexpr (requires { array.span(); }) {
          return to_elements(context, value, vrml::element_type(type), scene, array);
        } else {
          return false;
        }
      },
      field);
}

bool set_own(JSContext* context, Program& program, std::uint32_t place, JS::HandleValue value) {
  const FieldType type = program.interface(place).type;
  FieldValue field;
  if (!to_field(context, value, type, program.scene(), field)) return false;
  Engine& engine = program.world->engine();
  const std::size_t bytes = bytes_of(field), before = std::exchange(program.counted[place], bytes);
  engine.add_bytes(-static_cast<std::ptrdiff_t>(before));
  if (!engine.may_have(bytes)) {
    engine.add_bytes(static_cast<std::ptrdiff_t>(before));
    program.counted[place] = before;
    JS_ReportOutOfMemory(context);
    return false;
  }
  engine.add_bytes(static_cast<std::ptrdiff_t>(bytes));
  program.values[place] = std::move(field);
  program.world->calls().own_changed(program, place);
  return true;
}

bool write_back(JSContext* context, JS::HandleObject parent, std::uint32_t place, JS::HandleValue value) {
  if (!parent) return true;
  if (list_of(parent)) return set_element(context, parent, place, value);
  if (is_image(parent)) return image_array_changed(context, parent);
  if (node_of(parent)) return set_node_field(context, parent, place, value);
  if (Program* const program = program_of_global(parent)) return set_own(context, *program, place, value);
  return true;
}

}  // namespace gs::app::script

#include "base/json_fields.h"

#include <limits>
#include <nlohmann/json.hpp>

namespace relamp {
namespace {

constexpr size_t maxValues = 8'000'000;
constexpr int maxDepth = 32;

/// Refuses depth and size before the parser asks for memory. One pass over the text; strings are stepped over.
void checkSize(const std::string& text) {
    size_t values = 1;
    int depth = 0;
    for (size_t i = 0; i < text.size(); ++i) {
        switch (text[i]) {
            case '"':
                for (++i; i < text.size() && text[i] != '"'; ++i)
                    if (text[i] == '\\') ++i;
                break;
            case '[':
            case '{':
                if (++depth > maxDepth) throw Error("is nested deeper than {} levels", maxDepth);
                ++values;
                break;
            case ']':
            case '}': --depth; break;
            case ',': ++values; break;
            default: break;
        }
    }
    if (values > maxValues) throw Error("holds more than {} values", maxValues);
}

}  // namespace

Json parseJson(const std::string& text, const std::string& name) {
    const std::string where = name.empty() ? "" : name + ": ";
    try {
        checkSize(text);
        return Json::parse(text);
    } catch (const Json::exception& error) {
        // The library's text begins with its own name and number in brackets.
        std::string reason = error.what();
        if (const size_t end = reason.find("] "); end != std::string::npos) reason.erase(0, end + 2);
        if (reason.size() > 300) reason.resize(300);
        throw Error("{}is not valid JSON ({})", where, reason);
    } catch (const Error& error) { throw Error("{}{}", where, error.what()); }
}

std::string dumpJson(const Json& document, int indent, BadText bad) {
    try {
        return document.dump(indent, ' ', false,
                             bad == BadText::replace ? Json::error_handler_t::replace : Json::error_handler_t::strict);
    } catch (const Json::exception&) { throw Error("cannot be written as JSON: a text in it is not UTF-8"); }
}

const char* kindOf(const Json& value) {
    if (value.is_string()) return "text";
    if (value.is_boolean()) return "true or false";
    if (value.is_null()) return "null";
    if (value.is_array()) return "a list";
    if (value.is_object()) return "an object";
    return "a number";
}

std::string textOf(const Json& value, const std::string& where) {
    if (!value.is_string()) throw Error("{}: expected a text", where);
    return value.get_ref<const std::string&>();
}

bool flagOf(const Json& value, const std::string& where) {
    if (!value.is_boolean()) throw Error("{}: expected true or false", where);
    return value.get<bool>();
}

double numberOf(const Json& value, const std::string& where) {
    if (!value.is_number()) throw Error("{}: expected a number", where);
    const double x = value.get<double>();
    if (!std::isfinite(x)) throw Error("{}: is {:g}, which is out of range", where, x);
    return x;
}

DVec3 pointOf(const Json& value, const std::string& where) {
    if (!value.is_array() || value.size() != 3 || !value[0].is_number() || !value[1].is_number() ||
        !value[2].is_number())
        throw Error("{}: expected three numbers", where);
    const DVec3 p(value[0].get<double>(), value[1].get<double>(), value[2].get<double>());
    for (int c = 0; c < 3; ++c)
        if (!std::isfinite(float(p[c])))
            throw Error("{}[{}]: is {:g}, which is too large; expected at most {:g}", where, c, p[c],
                        std::numeric_limits<float>::max());
    return p;
}

const Json* JsonFields::find(const char* key) const {
    const auto at = object_->find(key);
    return at == object_->end() || at->is_null() ? nullptr : &*at;
}

const Json& JsonFields::need(const char* key) const {
    const auto at = object_->find(key);
    if (at == object_->end()) throw Error("{}: is missing", name(key));
    return *at;
}

template <class T>
T JsonFields::get(const char* key, const T& fallback) const {
    const Json* value = find(key);
    if (!value) return fallback;
    if constexpr (std::is_same_v<T, std::string>) return textOf(*value, name(key));
    else if constexpr (std::is_same_v<T, bool>) return flagOf(*value, name(key));
    else if constexpr (std::is_same_v<T, Vec3> || std::is_same_v<T, DVec3>) return T(pointOf(*value, name(key)));
    else {
        const double x = numberOf(*value, name(key));
        if (std::is_integral_v<T> && (x < 0 || x > 1.8e19 || (sizeof(T) < 8 && x > 2147483647.0)))
            throw Error("{}: is {:g}, which is out of range", name(key), x);
        if (std::is_same_v<T, float> && !std::isfinite(float(x)))
            throw Error("{}: is {:g}, which is too large", name(key), x);
        return value->get<T>();
    }
}

template bool JsonFields::get(const char*, const bool&) const;
template int JsonFields::get(const char*, const int&) const;
template uint64_t JsonFields::get(const char*, const uint64_t&) const;
template float JsonFields::get(const char*, const float&) const;
template double JsonFields::get(const char*, const double&) const;
template std::string JsonFields::get(const char*, const std::string&) const;
template Vec3 JsonFields::get(const char*, const Vec3&) const;
template DVec3 JsonFields::get(const char*, const DVec3&) const;

JsonFields JsonFields::object(const char* key) const {
    static const Json empty = Json::object();
    const auto at = object_->find(key);
    if (at != object_->end() && !at->is_object()) throw Error("{}: expected an object", name(key));
    return JsonFields(at == object_->end() ? empty : *at, name(key));
}

std::vector<JsonFields> JsonFields::list(const char* key) const {
    std::vector<JsonFields> elements;
    const auto at = object_->find(key);
    if (at == object_->end()) return elements;
    if (!at->is_array()) throw Error("{}: expected a list", name(key));
    for (const Json& element : *at) {
        std::string where = fmt::format("{}[{}]", name(key), elements.size());
        if (!element.is_object()) throw Error("{}: expected an object", where);
        elements.emplace_back(element, std::move(where));
    }
    return elements;
}

std::vector<float> JsonFields::numbers(const char* key) const {
    std::vector<float> values;
    const Json* list = find(key);
    if (list && list->is_array())
        for (const Json& value : *list)
            if (value.is_number()) values.push_back(value.get<float>());
    return values;
}

}  // namespace relamp

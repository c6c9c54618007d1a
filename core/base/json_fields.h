// JSON documents: parsed and written in one place, because that is what takes long to compile, and read field by field
// with errors that name the field ("emitters[2].radiance: expected three numbers").
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/math.h"

namespace relamp {

using Json = nlohmann::json;

/// Throws Error "NAME: is not valid JSON (...)" with line, column and reason; an empty name is left out. Refuses more
/// than 32 levels or 8 million values before the parser asks for memory.
Json parseJson(const std::string& text, const std::string& name = "");

/// What to do with text that is not UTF-8.
enum class BadText { refuse, replace };

/// One line with an indent of -1, else a line for every value. Throws Error for text that is not UTF-8.
std::string dumpJson(const Json& document, int indent = -1, BadText bad = BadText::refuse);

/// The kind of a value in words: "a number", "text".
const char* kindOf(const Json& value);

/// Values of one kind; `where` names them in errors.
std::string textOf(const Json& value, const std::string& where);
bool flagOf(const Json& value, const std::string& where);
double numberOf(const Json& value, const std::string& where);
DVec3 pointOf(const Json& value, const std::string& where);

/// The fields of an object. Of a key that is absent or null the fallback stands; a value of another kind, or a number
/// that is not finite or beyond the type, throws Error. The document must outlive this.
class JsonFields {
public:
    /// `where` is how errors name the object: "" for a document, "emitters[2]" for an element.
    explicit JsonFields(const Json& object, std::string where = "") : object_(&object), where_(std::move(where)) {}

    /// Null when the key is absent or null.
    const Json* find(const char* key) const;
    bool has(const char* key) const { return find(key) != nullptr; }
    /// Throws Error "KEY: is missing" when it is absent.
    const Json& need(const char* key) const;

    /// bool, int, uint64_t, float, double, std::string, Vec3 or DVec3. Whole numbers are 0 or more.
    template <class T>
    T get(const char* key, const T& fallback) const;
    template <class T>
    T get(const char* key) const {
        need(key);
        return get(key, T());
    }

    /// An empty object when the key is absent.
    JsonFields object(const char* key) const;
    /// The objects of a list; none when the key is absent.
    std::vector<JsonFields> list(const char* key) const;
    /// The numbers of a list; none when it is absent or no list. Anything else in it is left out.
    std::vector<float> numbers(const char* key) const;

    /// "emitters[2].radiance".
    std::string name(const char* key) const { return where_.empty() ? key : where_ + "." + key; }

private:
    const Json* object_;
    std::string where_;
};

}  // namespace relamp

// USD text (.usda) as far as cameras need it: prims with their transforms and lens; everything else is passed over.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace relamp {

/// A property's numbers, one list at each time; without time samples one list at time 0.
struct UsdValue {
    bool sampled = false;
    std::map<double, std::vector<double>> at;
    /// Linear between samples, constant beyond; empty when there is none.
    std::vector<double> value(double time) const;
};

struct UsdPrim {
    std::string type, name, path;
    int parent = -1;                         ///< index into UsdStage::prims
    std::map<std::string, UsdValue> values;  ///< numbers of xformOp:... and of cameras' lenses
    std::vector<std::string> order;          ///< xformOpOrder
};

struct UsdStage {
    std::string upAxis;          ///< "Y", "Z"; empty: not said
    double metresPerUnit = 0;    ///< 0: not said
    std::vector<UsdPrim> prims;  ///< parents before their children
};

/// Throws Error naming the file and the line. Cost: one pass over the text.
UsdStage readUsdText(const std::filesystem::path& file);

}  // namespace relamp

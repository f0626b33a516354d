// Data that were made of a scene beforehand for methods to use, by type: a skeleton, subspaces.
#pragma once

#include <map>
#include <memory>
#include <typeindex>

namespace lacuna {

class AssetSet {
  public:
    template <class T>
    void put(std::shared_ptr<const T> asset) {
        byType_[typeid(T)] = std::move(asset);
    }
    /// Null where there is none.
    template <class T>
    std::shared_ptr<const T> get() const {
        const auto found = byType_.find(typeid(T));
        return found == byType_.end() ? nullptr : std::static_pointer_cast<const T>(found->second);
    }

  private:
    std::map<std::type_index, std::shared_ptr<const void>> byType_;
};

}  // namespace lacuna

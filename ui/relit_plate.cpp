#include "relit_plate.h"

// The present frame of a plate relit in the background.
#pragma once

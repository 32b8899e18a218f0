include $(sort $(wildcard $(BR2_EXTERNAL_PUPIL_PATH)/pupil/*.mk))

# Writes FOLDER/NAME.1.gz, FOLDER/NAME.bash and FOLDER/_NAME: what PROGRAM, a list that begins with
# its emulator where there is one, says of itself.
foreach(form IN ITEMS man bash zsh)
  execute_process(COMMAND ${PROGRAM} --help-as ${form}
    OUTPUT_VARIABLE ${form} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
file(WRITE ${FOLDER}/${NAME}.1 "${man}")
file(WRITE ${FOLDER}/${NAME}.bash "${bash}")
file(WRITE ${FOLDER}/_${NAME} "${zsh}")
execute_process(COMMAND ${GZIP} -9nf ${FOLDER}/${NAME}.1 COMMAND_ERROR_IS_FATAL ANY)
